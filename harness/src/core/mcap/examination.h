// The examination of a file, in one pass: its damage, its deviations from the MCAP specification that mislead a reader,
// and the parts that can be saved. It has two ends: `rehearse doctor` prints the findings, recover.h writes a whole
// file of the saved parts. So the doctor's findings are what a recovery loses or mends.
//
// The pass computes every CRC, and compares every index and count with the records. After damage it searches for the
// next record, and examines the following ones too. The contents of messages are examined by a ContentCheck of the
// caller.
//
// Saved are:
// - a chunk or an attachment whose CRC matches; without a CRC, one that can be decompressed and whose records are
//   whole. Nothing is saved of a chunk whose CRC doesn't match, unless `trust_damaged` is set.
// - definitions and metadata whose fields have exactly their lengths. If definitions differ and the summary exists and
//   its CRC matches, the summary counts.
// - after damage, records that can be identified (see harness/TRACE_FORMAT.md).
//
// Memory: the size of the summary's indexes (some hundred bytes per chunk), and one chunk.
#pragma once

#include <rehearse/mcap.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "chunks.h"
#include "contents.h"

namespace rehearse::mcap {

/// A place in the file.
struct Place {
  std::uint64_t offset = 0;             // offset of a record in the file
  std::optional<std::uint64_t> inside;  // offset in the decompressed records of the chunk at `offset`
};

struct Finding {
  /// Error: data are lost, or a reader is misled. warning: data that some readers don't find, or find in a different
  /// order. note: unusual, without harm for a reader.
  Severity severity = Severity::error;
  Place place;
  std::string message;
};

/// The findings of each severity: the first ones, and the number of all.
class Findings {
 public:
  void add(Severity severity, Place place, std::string message);

  /// The findings in the order of discovery, the first thousand of each severity.
  const std::vector<Finding>& list() const { return list_; }
  /// The number of all findings of a severity, listed or not.
  std::uint64_t count(Severity severity) const { return counts_[static_cast<std::size_t>(severity)]; }
  bool has_error() const { return count(Severity::error) > 0; }

 private:
  std::vector<Finding> list_;
  std::uint64_t counts_[4] = {};
};

/// Examines the contents of the file during the pass.
class ContentCheck {
 public:
  virtual ~ContentCheck() = default;
  /// Called with every schema at its first occurrence.
  virtual void schema(const Schema& schema, Place place, Findings& findings) = 0;
  /// Called with every message of a known channel in whole chunks, in file order. `schema`: null if the channel has
  /// none.
  virtual void message(const Message& message, const Schema* schema, Place place, Findings& findings) = 0;
  /// Called with attachments without their data.
  virtual void attachment(const Attachment& attachment, Findings& findings) = 0;
  virtual void metadata(const Metadata& metadata, Findings& findings) = 0;
  /// Called after the last record. `size`: size of the file [bytes].
  virtual void end(std::uint64_t size, Findings& findings) = 0;
};

struct ExamineOptions {
  /// A chunk whose stated decompressed size is larger is lost [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
  /// Save the messages of a damaged chunk that seem whole.
  bool trust_damaged = false;
  ContentCheck* content = nullptr;  // null: contents aren't examined
  Progress progress;
};

/// Bytes of the file that can't be saved.
struct LostBytes {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;  // after the last byte
  std::string what;       // the finding: "the CRC of the Chunk doesn't match"
};

/// A span of the file whose records are saved.
struct SavedSpan {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  bool trusted = true;  // false: a damaged or cut chunk, of which only the messages that seem whole are saved
};

/// The result of an examination.
struct Examination {
  Findings findings;
  std::uint64_t size = 0;  // [bytes]
  std::uint64_t chunks = 0;
  std::uint64_t messages = 0;  // in whole chunks, and outside of chunks

  // The parts that can be saved.
  Contents contents;  // profile, library and definitions; statistics: from a summary whose CRC matches
  ChannelGroups groups;
  std::vector<SavedSpan> saved;  // in file order
  std::uint64_t lost_bytes = 0;
  std::vector<LostBytes> lost;                           // in order; the first thousand
  std::map<std::uint16_t, std::uint64_t> lost_messages;  // by channel, as the indexes of lost chunks state them
  std::uint64_t private_records = 0;
};

/// Fails if the file can't be read, or doesn't begin like an MCAP file.
Result<Examination> examine(const std::filesystem::path& file, const ExamineOptions& options = {});
/// Examines bytes even if they don't begin like an MCAP file. `view`: the view of them, whose memory is released; an
/// empty one for bytes of another source.
Examination examine_view(const FileView& view, Bytes bytes, const ExamineOptions& options);

}  // namespace rehearse::mcap
