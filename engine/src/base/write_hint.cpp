#include "write_hint.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <optional>
#include <system_error>

namespace rehearse {

namespace fs = std::filesystem;

fs::path disk_of(const fs::path& place) {
  const auto device_of = [](const fs::path& folder) {
    struct stat status {};
    return ::stat(folder.c_str(), &status) == 0 ? std::optional(status.st_dev) : std::nullopt;
  };
  std::error_code failed;
  fs::path disk = fs::canonical(place, failed);
  if (failed) return place;
  while (disk != disk.parent_path() && device_of(disk) == device_of(disk.parent_path())) disk = disk.parent_path();
  return disk;
}

std::string write_hint(const fs::path& file, std::string_view other) {
  std::error_code ignored;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  fs::path existing = folder;
  while (!fs::exists(existing, ignored) && existing != existing.parent_path())
    existing = existing.has_parent_path() ? existing.parent_path() : fs::path(".");
  std::string remedy;
  if (::access(existing.c_str(), W_OK) != 0)
    remedy = fmt::format("make the folder {} writable, or ", existing.string());
  else if (existing != folder)
    remedy = fmt::format("make the folder {} first, or ", folder.string());
  else if (::access(file.c_str(), F_OK) == 0 && ::access(file.c_str(), W_OK) != 0)
    remedy = fmt::format("make {} writable, or ", file.string());
  else if (const fs::space_info disk = fs::space(existing, ignored); !ignored && disk.available == 0)
    remedy = fmt::format("make room on the disk {}, or ", disk_of(existing).string());
  return remedy + std::string(other);
}

}  // namespace rehearse
