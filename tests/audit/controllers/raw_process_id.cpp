// Its command depends on its process id, read without the C library.
#include "zoo.h"

#include <sys/syscall.h>

namespace {

/// A system call without the C library.
inline long system_call(long number, long a, long b, long c) {
  long result = number;
  asm volatile("syscall" : "+a"(result) : "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
  return result;
}

class RawProcessId : public ZooController {
  double term() override { return 1e-9 * system_call(SYS_getpid, 0, 0, 0); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RawProcessId)
