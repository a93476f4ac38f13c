// The doctor: everything about a file that isn't as the MCAP specification has it, each with its place, in one pass.
//
// It believes nothing: every CRC is computed, every index and count is compared with what is there. Behind damage it
// looks for where records go on, and examines those too. What is in the messages is somebody else's matter, who may
// look over its shoulder: ContentCheck.
//
// Memory: what the summary's indexes take (some hundred bytes a chunk), and one chunk.
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

/// Where something is.
struct Place {
  std::uint64_t offset = 0;             // of a record, in the file
  std::optional<std::uint64_t> inside;  // in the decompressed records of the chunk that is at `offset`
};

struct Finding {
  Severity severity = Severity::error;  // error: against the specification. warning: against its advice. note: unusual
  Place place;
  std::string message;
};

/// What was found of one severity: the first ones, and how many there are.
class Findings {
 public:
  Findings() = default;
  explicit Findings(std::size_t limit) : limit_(limit) {}

  void add(Severity severity, Place place, std::string message);

  /// In the order in which they were found; of each severity up to the limit.
  const std::vector<Finding>& list() const { return list_; }
  /// Listed or not.
  std::uint64_t count(Severity severity) const { return counts_[static_cast<std::size_t>(severity)]; }
  bool has_error() const { return count(Severity::error) > 0; }

 private:
  std::size_t limit_ = 1000;
  std::vector<Finding> list_;
  std::uint64_t counts_[4] = {};
};

/// Looks at what the file holds while the doctor passes over it.
class ContentCheck {
 public:
  virtual ~ContentCheck() = default;
  /// Every schema, when it is met first.
  virtual void schema(const Schema& schema, Place place, Findings& findings) = 0;
  /// Every message of a known channel out of whole chunks, in file order. `schema`: null if the channel has none.
  virtual void message(const Message& message, const Schema* schema, Place place, Findings& findings) = 0;
  /// Attachments come without their data.
  virtual void attachment(const Attachment& attachment, Findings& findings) = 0;
  virtual void metadata(const Metadata& metadata, Findings& findings) = 0;
  /// After the last record. `size` of the file [bytes].
  virtual void end(std::uint64_t size, Findings& findings) = 0;
};

struct DoctorOptions {
  /// A chunk that says it is larger decompressed isn't looked into [bytes].
  std::uint64_t max_chunk_size = std::uint64_t{1} << 30;
  ContentCheck* content = nullptr;  // null: nobody looks
  /// Called now and then with the bytes passed and all; null: not.
  std::function<void(std::uint64_t done, std::uint64_t all)> progress;
};

/// What an examination came to.
struct Examination {
  Findings findings;
  std::string profile;
  std::string library;
  std::uint64_t size = 0;  // [bytes]
  std::uint64_t chunks = 0;
  std::uint64_t messages = 0;
};

/// Fails if the file can't be read, or if it doesn't begin as an MCAP file: then there is nothing to examine.
Result<Examination> examine(const std::filesystem::path& file, const DoctorOptions& options = {});
/// The same of bytes; `name` is what the failure calls them.
Result<Examination> examine_bytes(Bytes bytes, const std::string& name, const DoctorOptions& options = {});

}  // namespace rehearse::mcap
