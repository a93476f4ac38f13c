// Reads the clock by a system call without the C library.
#include "zoo.h"

#include <sys/syscall.h>
#include <ctime>

namespace {

/// A system call without the C library.
inline long system_call(long number, long a, long b, long c) {
  long result = number;
  asm volatile("syscall" : "+a"(result) : "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
  return result;
}

class RawClock : public ZooController {
  double term() override {
    timespec now{};
    system_call(SYS_clock_gettime, CLOCK_MONOTONIC, reinterpret_cast<long>(&now), 0);
    return 1e-12 * now.tv_nsec;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RawClock)
