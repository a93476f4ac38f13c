// FileIdentity: which file a path names, and in which state. Internal.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>

namespace rehearse {

/// Two equal identities are those of one file that nobody has changed in between, unless a change came within the
/// resolution of the file system's clock.
struct FileIdentity {
  std::uint64_t device = 0, inode = 0, size = 0;
  std::int64_t modified = 0, changed = 0;  // [ns]; no program can set the second

  bool operator==(const FileIdentity&) const = default;
  /// None: there is no such file.
  static std::optional<FileIdentity> of(const std::filesystem::path& file);
  /// True if the last change was before such a time: then a later one gives another identity.
  bool is_older_than(std::chrono::nanoseconds age) const;
};

}  // namespace rehearse
