// The functions of the C library that process_tripwires.cpp replaces, as they would be called without it. To be
// included without _FORTIFY_SOURCE, which declares inline functions with the names of those that open files.
#pragma once

#include <fcntl.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#include "c_functions.h"
#include "c_library.h"

namespace rehearse {

/// They are looked up when this library is loaded, because a look-up takes the lock of the dynamic linker. A call that
/// was ended while a library was loaded or unloaded holds this lock for ever. A macro instead of a template, because
/// clang gives functions that return and functions that don't the same type name.
struct NextFunctions {
#define REHEARSE_NEXT_guarded(function) decltype(&(::function)) function##_;
#define REHEARSE_NEXT_derived(function)
#define REHEARSE_NEXT_free(function)
#define REHEARSE_MEMBER(function, source, guard) REHEARSE_NEXT_##guard(function)
  REHEARSE_C_FUNCTIONS(REHEARSE_MEMBER)
#undef REHEARSE_NEXT_guarded
};

const NextFunctions& next_functions();

#define REHEARSE_NEXT(function) ::rehearse::next_functions().function##_

}  // namespace rehearse
