// Recovery: a whole file of what can be saved from one that is cut, damaged or partly zeros.
//
// What is believed:
// - a chunk or an attachment whose CRC matches; without a CRC, one that can be decompressed and whose records are
// whole.
//   Of a chunk whose CRC doesn't match nothing is believed, unless `trust_damaged` asks for it.
// - definitions and metadata whose fields come to their lengths. If the file still has its summary and the summary's
// CRC
//   matches, that decides where definitions differ.
// - behind damage, records that can be told for some (see harness/TRACE_FORMAT.md).
//
// Indexes, statistics and CRCs are made anew. Private records aren't kept.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::mcap {

struct RecoverOptions {
  /// Takes from a damaged chunk the messages that seem whole, up to where it can't be decompressed any further. Nothing
  /// says that they are what was written.
  bool trust_damaged = false;
  /// A chunk that says it is larger decompressed is given up [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
  /// Called now and then with the bytes passed and all, in two passes; null: not.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;
};

/// Bytes of the source that aren't in what was written.
struct LostBytes {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;  // behind the last
  std::string what;       // "a Chunk whose CRC doesn't match"
};

/// Of one channel.
struct RecoveredChannel {
  std::string topic;
  std::uint64_t saved = 0;  // messages
  std::uint64_t lost = 0;   // as far as statistics and indexes that are left can tell
};

struct Recovery {
  std::uint64_t size = 0;                                     // of the source [bytes]
  std::uint64_t messages = 0, attachments = 0, metadata = 0;  // saved
  std::uint64_t lost_bytes = 0;
  std::vector<LostBytes> lost;                         // in order; the first thousand
  std::vector<std::string> remarks;                    // sentences on what else isn't as it was
  std::map<std::uint16_t, RecoveredChannel> channels;  // by their ids in the source
  std::uint64_t lost_messages = 0;                     // as far as can be told; 0: none, or it can't be
  bool loss_is_known = false;                          // the source's statistics are left, so that number is exact
  std::uint64_t first_time = 0, last_time = 0;         // log times of what was saved [ns]
  std::optional<std::uint64_t> source_last_time;  // of the last message that there was, if statistics are left [ns]

  /// Nothing is missing: the file was whole already.
  bool is_whole() const { return lost.empty() && remarks.empty(); }
};

/// Writes `target` (under another name until it is whole), opens it again and examines it. Unless the source was whole,
/// `target` has a metadata record `rehearse.recover` that says what is missing. Fails, with nothing written, if there
/// is nothing to be saved: no message, no attachment, no metadata; or if `target` can't be written.
Result<Recovery> recover(const std::filesystem::path& source, const std::filesystem::path& target,
                         const RecoverOptions& options = {});

}  // namespace rehearse::mcap
