#include "own_library.h"

#include <dlfcn.h>

#include <system_error>

namespace rehearse {

std::filesystem::path own_library_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&own_library_folder), &info) == 0 || !info.dli_fname) return {};
  std::error_code ignored;
  return std::filesystem::weakly_canonical(info.dli_fname, ignored).parent_path();
}

}  // namespace rehearse
