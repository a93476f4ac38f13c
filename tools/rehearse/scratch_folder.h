// ScratchFolder: a folder for files of a verb's processes; the destructor removes it with all its files.
#pragma once

#include <filesystem>
#include <system_error>
#include <utility>

namespace rehearse::tool {

class ScratchFolder {
 public:
  /// The processes that write into the folder create it; empty: there is no folder.
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rehearse::tool
