#include "gl_functions.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <rehearse/renderer.h>

#include <string>

namespace rehearse::gl {

#define REHEARSE_DEFINE(name) decltype(&::name) name = nullptr;
REHEARSE_OSMESA_FUNCTIONS(REHEARSE_DEFINE)
REHEARSE_GL_FUNCTIONS(REHEARSE_DEFINE)
#undef REHEARSE_DEFINE

namespace {

template <class Function>
void set(Function& function, const char* name, void* address, std::string& missing) {
  function = reinterpret_cast<Function>(address);
  if (!address && missing.empty()) missing = name;
}

Result<void> load() {
  void* library = ::dlopen(Renderer::library, RTLD_NOW | RTLD_LOCAL);
  if (!library) return error(fmt::format("OSMesa can't be loaded: {}", ::dlerror()), "apt install libosmesa6");
  std::string missing;
#define REHEARSE_SET(name) set(name, #name, ::dlsym(library, #name), missing);
  REHEARSE_OSMESA_FUNCTIONS(REHEARSE_SET)
#undef REHEARSE_SET
#define REHEARSE_SET(name) set(name, #name, reinterpret_cast<void*>(OSMesaGetProcAddress(#name)), missing);
  if (missing.empty()) {
    REHEARSE_GL_FUNCTIONS(REHEARSE_SET)
  }
#undef REHEARSE_SET
  if (!missing.empty()) return error(fmt::format("OSMesa has no {}", missing), "Mesa 17 or later is needed");
  return {};
}

}  // namespace

Result<void> load_functions() {
  static const Result<void> loaded = load();
  return loaded;
}

}  // namespace rehearse::gl
