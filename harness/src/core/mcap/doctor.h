// The doctor: reports every violation of the MCAP specification in a file with its place, in one pass.
//
// It computes every CRC, and compares every index and count with the records. After damage it searches for the next
// record, and examines the following ones too. The contents of messages are examined by a ContentCheck of the caller.
//
// Memory: the size of the summary's indexes (some hundred bytes per chunk), and one chunk.
#pragma once

#include <rehearse/mcap.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::mcap {

/// A place in the file.
struct Place {
  std::uint64_t offset = 0;             // offset of a record in the file
  std::optional<std::uint64_t> inside;  // offset in the decompressed records of the chunk at `offset`
};

struct Finding {
  /// Error: violates the specification. warning: violates its advice. note: unusual.
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

/// Examines the contents of the file while the doctor passes over it.
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

struct DoctorOptions {
  /// A chunk whose stated decompressed size is larger isn't examined [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
  ContentCheck* content = nullptr;  // null: contents aren't examined
  /// Called now and then with the number of passed bytes and the number of all bytes; null: never called.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;
};

/// The result of an examination.
struct Examination {
  Findings findings;
  std::string profile;
  std::string library;
  std::uint64_t size = 0;  // [bytes]
  std::uint64_t chunks = 0;
  std::uint64_t messages = 0;
};

/// Fails if the file can't be read, or doesn't begin like an MCAP file: then nothing can be examined.
Result<Examination> examine(const std::filesystem::path& file, const DoctorOptions& options = {});
/// Examines bytes; `name` is their name in a failure.
Result<Examination> examine_bytes(Bytes bytes, const std::string& name, const DoctorOptions& options = {});

}  // namespace rehearse::mcap
