#undef _FORTIFY_SOURCE  // see next_functions.h
#include "next_functions.h"

#include <dlfcn.h>
#include <gnu/lib-names.h>

namespace rehearse {

/// In a program that loads the C library before this one, no function comes next: the C library's own is used.
void* next_function(const char* name) {
  if (void* next = dlsym(RTLD_NEXT, name)) return next;
  // dlopen() by its name would be this library's replacement, whose next function isn't known yet.
  static const auto open = reinterpret_cast<decltype(&dlopen)>(dlsym(RTLD_DEFAULT, "dlopen"));
  static void* const c_library = open(LIBC_SO, RTLD_LAZY | RTLD_NOLOAD);
  return dlsym(c_library ? c_library : RTLD_DEFAULT, name);
}

const NextFunctions& next_functions() {
  static const NextFunctions all{
#define REHEARSE_NEXT_guarded(function) reinterpret_cast<decltype(&(::function))>(next_function(#function)),
      REHEARSE_C_FUNCTIONS(REHEARSE_MEMBER)
#undef REHEARSE_NEXT_guarded
  };
  return all;
}

namespace {
[[maybe_unused]] const NextFunctions& looked_up_at_loading = next_functions();
}  // namespace

bool replaces_functions() {
  // All are replaced, or none, because the libraries are searched one after the other.
  constexpr const char* one = "uselocale";
  static void* const program = dlopen(nullptr, RTLD_LAZY | RTLD_NOLOAD);
  static void* const c_library = dlopen(LIBC_SO, RTLD_LAZY | RTLD_NOLOAD);
  if (!program || !c_library) return true;
  return dlsym(program, one) != dlsym(c_library, one);
}

void leave_process(int status) {
  REHEARSE_NEXT(_exit)(status);
  __builtin_unreachable();
}

}  // namespace rehearse
