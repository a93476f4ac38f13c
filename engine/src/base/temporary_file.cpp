#include "temporary_file.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace rehearse {

TemporaryFile::TemporaryFile() {
  std::error_code none;
  folder_ = std::filesystem::temp_directory_path(none).string();
  if (none) {
    folder_ = "the folder for temporary files";
    errno = none.value();
    return;
  }
  descriptor_ = FileDescriptor(::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600));
  if (descriptor_ >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != ENOENT)) return;
  std::string name = folder_ + "/rehearse.XXXXXX";  // not every file system supports nameless files
  descriptor_ = FileDescriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (descriptor_ >= 0) ::unlink(name.c_str());
}

bool TemporaryFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return false;
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

std::uint64_t TemporaryFile::size() const {
  struct stat status {};
  return ::fstat(descriptor_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

std::string TemporaryFile::path() const { return fmt::format("/proc/self/fd/{}", descriptor()); }

}  // namespace rehearse
