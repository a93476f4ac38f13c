// A library that replaces the C library's sine by the same function: only a process with other code must be noticed.
#include <dlfcn.h>

extern "C" double sin(double angle) {
  static const auto original = reinterpret_cast<double (*)(double)>(dlsym(RTLD_NEXT, "sin"));
  return original(angle);
}
