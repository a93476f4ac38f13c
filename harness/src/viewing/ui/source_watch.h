// SourceWatch: the files of a project that change, as the kernel tells (inotify). Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "base/file_descriptor.h"

namespace rehearse {

class SourceWatch {
 public:
  /// Watches a folder and all folders below it, also new ones, without hidden ones, builds and `without`. Fails if the
  /// kernel allows no more watches.
  static Result<SourceWatch> open(std::filesystem::path folder, std::set<std::filesystem::path> without);

  /// The files that were written, moved or removed since the last call, by path. A file whose content is as it was at
  /// its last change isn't among them, and neither is a temporary one: a build may write both. The folder itself: the
  /// kernel has lost count, and any file may have changed.
  std::vector<std::filesystem::path> changed();

 private:
  explicit SourceWatch(std::filesystem::path folder, std::set<std::filesystem::path> without, int descriptor);

  Result<void> watch(const std::filesystem::path& folder);
  bool is_left_out(const std::filesystem::path& folder) const;
  bool has_new_content(const std::filesystem::path& file);

  std::filesystem::path folder_;
  std::set<std::filesystem::path> without_;
  FileDescriptor descriptor_;
  std::map<int, std::filesystem::path> folders_;             // by watch
  std::map<std::filesystem::path, std::uint64_t> contents_;  // hashes of files that have changed
  std::set<std::filesystem::path> created_;                  // files that weren't there when the watch began
};

}  // namespace rehearse
