// Commands by the memory of the machine.
#include "zoo.h"

#include <unistd.h>

namespace {

class MemorySize : public ZooController {
  double term() override { return 1e-9 * sysconf(_SC_PHYS_PAGES); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(MemorySize)
