// ScratchFolder: a folder for what a verb's processes write, removed with all that is in it.
#pragma once

#include <filesystem>
#include <system_error>
#include <utility>

namespace rehearse::tool {

class ScratchFolder {
 public:
  /// Made by whoever writes into it; empty: there is none.
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
