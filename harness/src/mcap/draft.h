// A file that gets its name only when it is whole. Internal.
#pragma once

#include <rehearse/diagnostic.h>

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
  /// Gives it its name; what had that name is replaced.
  Result<void> finish();

 private:
  Draft(std::filesystem::path target, std::filesystem::path file)
      : target_(std::move(target)), file_(std::move(file)) {}
  std::filesystem::path target_;
  std::filesystem::path file_;  // empty: finished, or moved from
};

}  // namespace rehearse::mcap
