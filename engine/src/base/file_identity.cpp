#include "file_identity.h"

#include <sys/stat.h>

namespace rehearse {
namespace {

std::int64_t nanoseconds(const timespec& time) { return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec; }

}  // namespace

std::optional<FileIdentity> FileIdentity::of(const std::filesystem::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return std::nullopt;
  return FileIdentity{found.st_dev, found.st_ino, static_cast<std::uint64_t>(found.st_size), nanoseconds(found.st_mtim),
                      nanoseconds(found.st_ctim)};
}

bool FileIdentity::is_older_than(std::chrono::nanoseconds age) const {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return changed < std::chrono::duration_cast<std::chrono::nanoseconds>(now - age).count();
}

}  // namespace rehearse
