// Writes a message by a system call without the C library.
#include "zoo.h"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

/// A system call without the C library.
inline long system_call(long number, long a, long b, long c) {
  long result = number;
  asm volatile("syscall" : "+a"(result) : "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
  return result;
}

class RawWrite : public ZooController {
  double term() override {
    const int nothing = open("/dev/null", O_WRONLY);
    system_call(SYS_write, nothing, reinterpret_cast<long>("tick"), 4);
    close(nothing);
    return -0.1 * joint_->q();
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(RawWrite)
