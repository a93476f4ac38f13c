// Reads a random number by a system call without the C library.
#include "zoo.h"

#include <sys/syscall.h>

namespace {

/// A system call without the C library.
inline long system_call(long number, long a, long b, long c) {
  long result = number;
  asm volatile("syscall" : "+a"(result) : "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
  return result;
}

class RawGetrandom : public ZooController {
  double term() override {
    unsigned char number = 0;
    system_call(SYS_getrandom, reinterpret_cast<long>(&number), 1, 0);
    return 1e-6 * number;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RawGetrandom)
