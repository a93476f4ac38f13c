#include "growing_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

namespace rehearse {
namespace {

/// True if a process has locked the file against other writers, as a Writer does. The lock is looked up: to take it for
/// a moment could make a Writer fail.
bool is_being_written(std::uint64_t inode) {
  std::ifstream locks("/proc/locks");
  const std::string file = fmt::format(":{} ", inode);
  for (std::string line; std::getline(locks, line);)
    if (line.find("FLOCK") != std::string::npos && line.find("WRITE") != std::string::npos &&
        line.find("->") == std::string::npos && line.find(file) != std::string::npos)
      return true;
  return false;
}

}  // namespace

bool GrowingFile::look() {
  if (finished_) return false;
  if (descriptor_ < 0) {
    FileDescriptor opened(::open(file_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    struct stat status {};
    if (opened < 0 || ::fstat(opened, &status) != 0 || !S_ISREG(status.st_mode) || !is_being_written(status.st_ino))
      return false;
    descriptor_ = std::move(opened);
    inode_ = status.st_ino;
  }
  finished_ = !is_being_written(inode_);  // before its size is read: then the size is the last
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) return finished_;
  const auto size = static_cast<std::uint64_t>(status.st_size);
  return std::exchange(size_, size) != size || finished_;
}

std::optional<std::filesystem::path> GrowingFile::opened() const {
  if (descriptor_ < 0) return std::nullopt;
  return fmt::format("/proc/self/fd/{}", static_cast<int>(descriptor_));
}

}  // namespace rehearse
