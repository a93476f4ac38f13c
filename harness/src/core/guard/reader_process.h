// Readers of libraries' files: child processes that load what they need, so that this one stays as it is.
#pragma once

#include <dlfcn.h>

#include <cstdio>
#include <functional>
#include <string>
#include <type_traits>

namespace rehearse {

/// What `print` writes in a child process. Empty if there is none.
std::string text_of_child(const std::function<void(std::FILE* to)>& print);

/// Functions of a library that isn't linked: no run depends on it. It stays loaded.
class LibraryFunctions {
 public:
  explicit LibraryFunctions(const char* library) : library_(::dlopen(library, RTLD_NOW | RTLD_LOCAL)) {}

  /// False: the library isn't installed, or has no such function.
  template <class Function>
  bool operator()(const char* name, Function& function) const {
    function = library_ ? reinterpret_cast<Function>(::dlsym(library_, name)) : nullptr;
    return function != nullptr;
  }

 private:
  void* library_;
};

}  // namespace rehearse
