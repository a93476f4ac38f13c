#include "write_hint.h"

#include <fmt/format.h>
#include <unistd.h>

#include <system_error>

namespace rehearse {

namespace fs = std::filesystem;

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
    remedy = "make room on the disk, or ";
  return remedy + std::string(other);
}

}  // namespace rehearse
