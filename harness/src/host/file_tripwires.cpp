// Replacements of the C library's functions that open files to read (see process_tripwires.cpp).
//
// Outside of a guarded call they only call the functions of libc; in one they first note the file's name.
#undef _FORTIFY_SOURCE  // it declares inline functions with these names
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>

#include "guarded_call.h"
#include "opened_files.h"

namespace {

/// The functions that would be called without these replacements. They are looked up when this library is loaded,
/// because a look-up takes the lock of the dynamic linker. A call that was ended while a library was loaded holds this
/// lock for ever.
struct NextFunctions {
#define REHEARSE_MEMBER(function) \
  decltype(&(::function)) function##_ = reinterpret_cast<decltype(&(::function))>(dlsym(RTLD_NEXT, #function));
  REHEARSE_MEMBER(open)
  REHEARSE_MEMBER(open64)
  REHEARSE_MEMBER(openat)
  REHEARSE_MEMBER(openat64)
  REHEARSE_MEMBER(fopen)
  REHEARSE_MEMBER(fopen64)
#undef REHEARSE_MEMBER
};

const NextFunctions& next() {
  static const NextFunctions all;
  return all;
}
[[maybe_unused]] const NextFunctions& looked_up_at_loading = next();

void note(const char* path, int flags) {
  if ((flags & O_ACCMODE) != O_WRONLY && !(flags & O_TRUNC) && rehearse::in_guarded_call())
    rehearse::note_opened_file(path);
}

void note(const char* path, const char* mode) {
  if (mode && mode[0] == 'r' && rehearse::in_guarded_call()) rehearse::note_opened_file(path);
}

/// The mode of a file that may be created.
mode_t mode_in(int flags, va_list arguments) {
  const bool makes = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  return makes ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

#define DEFINE_OPEN(name)                          \
  int name(const char* path, int flags, ...) {     \
    va_list arguments;                             \
    va_start(arguments, flags);                    \
    const mode_t mode = mode_in(flags, arguments); \
    va_end(arguments);                             \
    note(path, flags);                             \
    return next().name##_(path, flags, mode);      \
  }
DEFINE_OPEN(open)
DEFINE_OPEN(open64)

#define DEFINE_OPENAT(name)                                \
  int name(int folder, const char* path, int flags, ...) { \
    va_list arguments;                                     \
    va_start(arguments, flags);                            \
    const mode_t mode = mode_in(flags, arguments);         \
    va_end(arguments);                                     \
    if (folder == AT_FDCWD) note(path, flags);             \
    return next().name##_(folder, path, flags, mode);      \
  }
DEFINE_OPENAT(openat)
DEFINE_OPENAT(openat64)

#define DEFINE_FOPEN(name)                         \
  FILE* name(const char* path, const char* mode) { \
    note(path, mode);                              \
    return next().name##_(path, mode);             \
  }
DEFINE_FOPEN(fopen)
DEFINE_FOPEN(fopen64)

}  // extern "C"
