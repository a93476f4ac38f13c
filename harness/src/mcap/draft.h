// A file that is made of others, and that gets its name only when it is whole. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <filesystem>
#include <span>

namespace rehearse::mcap {

class Draft {
 public:
  /// For `target`, written beside it under another name. Fails if that is a directory, a pipe or a device, or one of
  /// the `sources` that it is made from.
  static Result<Draft> begin(const std::filesystem::path& target, std::span<const std::filesystem::path> sources);
  /// Removes what wasn't finished.
  ~Draft();
  Draft(Draft&& other) noexcept;
  Draft& operator=(Draft&&) = delete;

  /// Where to write.
  const std::filesystem::path& file() const { return file_; }
  /// Writes it. Its chunks are finished by their size only: nothing waits to be killed here.
  Result<std::unique_ptr<Writer>> open_writer(WriterOptions form) const;
  /// [bytes] that are written.
  std::uint64_t size() const;
  /// Gives it its name; what had that name is replaced.
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
