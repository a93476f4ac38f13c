// Reads a random number by syscall().
#include "zoo.h"

#include <sys/syscall.h>
#include <unistd.h>

namespace {

class SyscallGetrandom : public ZooController {
  double term() override {
    unsigned char number = 0;
    syscall(SYS_getrandom, &number, 1, 0);
    return 1e-6 * number;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SyscallGetrandom)
