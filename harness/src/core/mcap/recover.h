// Recovery: makes a whole file of the undamaged data of a file that is cut, damaged or partly zeros. An examination
// (examination.h) finds the data that can be saved.
//
// Indexes, statistics and CRCs are computed again. Private records aren't kept.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "examination.h"

namespace rehearse::mcap {

struct RecoverOptions {
  /// Keeps those messages of a damaged chunk that seem whole, up to the end of its decompression. They may differ from
  /// the written messages.
  bool trust_damaged = false;
  /// A chunk whose stated decompressed size is larger is lost [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
  /// Called now and then, in two passes, with the number of passed bytes and the number of all bytes; null: never
  /// called.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;
};

/// The messages of one channel.
struct RecoveredChannel {
  std::string topic;
  std::uint64_t saved = 0;  // number of saved messages
  std::uint64_t lost = 0;   // number of lost messages, as far as the remaining statistics and indexes state it
};

struct Recovery {
  std::uint64_t size = 0;                                     // size of the source [bytes]
  std::uint64_t messages = 0, attachments = 0, metadata = 0;  // numbers of saved records
  std::uint64_t lost_bytes = 0;
  std::vector<LostBytes> lost;                         // in order; the first thousand
  std::vector<std::string> remarks;                    // sentences: other differences from the source; errors mended
  std::map<std::uint16_t, RecoveredChannel> channels;  // by their ids in the source
  std::uint64_t lost_messages = 0;                     // 0: none, or an unknown number
  bool loss_is_known = false;                   // lost_messages is exact: by the source's statistics, or its database
  std::uint64_t first_time = 0, last_time = 0;  // log times of the saved messages [ns]
  /// Log time of the last message in the source, if statistics exist [ns].
  std::optional<std::uint64_t> source_last_time;

  /// True if nothing is missing: the source was whole.
  bool is_whole() const { return lost.empty() && remarks.empty(); }
};

/// Writes `target` (under a temporary name until it is complete), opens it again and examines it. Unless the source was
/// whole, `target` has a metadata record `rehearse.recover` that states the losses. Fails, and writes nothing, if
/// nothing can be saved (no message, no attachment, no metadata), or if `target` can't be written.
Result<Recovery> recover(const std::filesystem::path& source, const std::filesystem::path& target,
                         const RecoverOptions& options = {});

}  // namespace rehearse::mcap
