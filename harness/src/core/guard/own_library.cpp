#include "own_library.h"

#include <dlfcn.h>

#include <system_error>

namespace rehearse {

namespace {

std::filesystem::path find_own_library_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_library_folder), &info) == 0 || !info.dli_fname) return {};
  std::error_code ignored;
  return std::filesystem::weakly_canonical(info.dli_fname, ignored).parent_path();
}

}  // namespace

std::filesystem::path own_library_folder() {
  static const auto& folder = *new auto(find_own_library_folder());
  return folder;
}

}  // namespace rehearse
