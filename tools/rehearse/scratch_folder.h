// ScratchFolder: a folder for files of a verb's processes; the destructor removes it with all its files.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

namespace rehearse::tool {

class ScratchFolder {
 public:
  /// The processes that write into the folder create it; empty: there is no folder.
  explicit ScratchFolder(std::filesystem::path path) : path_(std::move(path)) {}
  /// A new folder among the system's temporary files; path() is empty if it can't be created.
  static ScratchFolder temporary() {
    std::error_code failed;
    std::string name = (std::filesystem::temp_directory_path(failed) / "rehearse.XXXXXX").string();
    return ScratchFolder(!failed && mkdtemp(name.data()) ? std::filesystem::path(name) : std::filesystem::path());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rehearse::tool
