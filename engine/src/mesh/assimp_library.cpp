#include "assimp_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <system_error>
#include <utility>

namespace rehearse {
namespace {

using ReadMesh = decltype(rehearse_read_by_assimp);

Result<ReadMesh*> load_assimp() {
  const std::filesystem::path file = assimp_library();
  void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);  // stays loaded
  void* function = library ? ::dlsym(library, "rehearse_read_by_assimp") : nullptr;
  if (!function)
    return error(fmt::format("it needs assimp: {}", ::dlerror()), "that library is installed together with rehearse");
  return reinterpret_cast<ReadMesh*>(function);
}

}  // namespace

std::filesystem::path assimp_library() {
  Dl_info own{};
  if (::dladdr(reinterpret_cast<const void*>(&assimp_library), &own) == 0 || !own.dli_fname) return {};
  std::error_code ignored;
  return std::filesystem::weakly_canonical(own.dli_fname, ignored).parent_path() / "rehearse/librehearse_assimp.so";
}

Result<MeshReading> read_by_assimp(MeshFormat format, MeshInput& input, const Eigen::Vector3d& scale,
                                   const MeshSelection& selection) {
  static const auto& read = *new auto(load_assimp());
  if (!read) return read.errors();
  MeshReading reading;
  Diagnostics errors;
  if (!(*read)(format, input, scale, selection, reading, errors)) return errors;
  return reading;
}

}  // namespace rehearse
