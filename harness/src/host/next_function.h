// For functions that stand in front of the C library's.
#pragma once

#include <dlfcn.h>

/// The function of that name that would have been found without ours. No template: clang gives the types of functions that
/// return and of those that don't one name.
#define NEXT(function) reinterpret_cast<decltype(&(function))>(dlsym(RTLD_NEXT, #function))
