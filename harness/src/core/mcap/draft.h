// A file made from other files, which gets its name only when it is complete. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <span>

namespace rehearse::mcap {

class Draft {
 public:
  /// Begins a draft for `target`, written beside it under a temporary name. Fails if `target` is a directory, a pipe or
  /// a device, or one of the `sources`.
  static Result<Draft> begin(const std::filesystem::path& target, std::span<const std::filesystem::path> sources);
  /// Removes an unfinished file.
  ~Draft();
  Draft(Draft&& other) noexcept;
  Draft& operator=(Draft&&) = delete;

  /// The file to write.
  const std::filesystem::path& file() const { return file_; }
  /// Opens a Writer for it. Its chunks are finished by their size only, because no data must survive a kill here.
  Result<std::unique_ptr<Writer>> open_writer(WriterOptions form) const;
  /// Number of written bytes.
  std::uint64_t size() const;
  /// Renames the file to its target, which is replaced.
  Result<void> finish();

 private:
  Draft(std::filesystem::path target, std::filesystem::path file)
      : target_(std::move(target)), file_(std::move(file)) {}
  std::filesystem::path target_;
  std::filesystem::path file_;  // empty: finished, or moved from
};

/// Adds a schema of a source; returns its id in the new file, 0 for null.
std::uint16_t copy(const Schema* schema, Writer& to);
Result<void> copy(const Attachment& attachment, Writer& to);

}  // namespace rehearse::mcap
