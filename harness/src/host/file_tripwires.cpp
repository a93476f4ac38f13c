// The functions of the C library that open files to read, in front of its own (see process_tripwires.cpp).
//
// Outside of a guarded call they do what libc's do; in one they note the file's name before.
#undef _FORTIFY_SOURCE  // whose inline functions have these names
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "guarded_call.h"
#include "next_function.h"
#include "opened_files.h"

namespace {

void note(const char* path, int flags) {
  if ((flags & O_ACCMODE) != O_WRONLY && !(flags & O_TRUNC) && rehearse::in_guarded_call())
    rehearse::note_opened_file(path);
}

void note(const char* path, const char* mode) {
  if (mode && mode[0] == 'r' && rehearse::in_guarded_call()) rehearse::note_opened_file(path);
}

/// The mode of a file that may be made.
mode_t mode_in(int flags, va_list arguments) {
  return flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

#define DEFINE_OPEN(name)                            \
  int name(const char* path, int flags, ...) {       \
    va_list arguments;                               \
    va_start(arguments, flags);                      \
    const mode_t mode = mode_in(flags, arguments);   \
    va_end(arguments);                               \
    note(path, flags);                               \
    return NEXT(name)(path, flags, mode);            \
  }
DEFINE_OPEN(open)
DEFINE_OPEN(open64)

#define DEFINE_OPENAT(name)                                   \
  int name(int folder, const char* path, int flags, ...) {    \
    va_list arguments;                                        \
    va_start(arguments, flags);                               \
    const mode_t mode = mode_in(flags, arguments);            \
    va_end(arguments);                                        \
    if (folder == AT_FDCWD) note(path, flags);                \
    return NEXT(name)(folder, path, flags, mode);             \
  }
DEFINE_OPENAT(openat)
DEFINE_OPENAT(openat64)

#define DEFINE_FOPEN(name)                            \
  FILE* name(const char* path, const char* mode) {    \
    note(path, mode);                                 \
    return NEXT(name)(path, mode);                    \
  }
DEFINE_FOPEN(fopen)
DEFINE_FOPEN(fopen64)

}  // extern "C"
