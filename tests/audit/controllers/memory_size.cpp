// Its command depends on the size of the machine's memory.
#include "zoo.h"

#include <unistd.h>

namespace {

class MemorySize : public ZooController {
  double term() override { return 1e-9 * sysconf(_SC_PHYS_PAGES); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(MemorySize)
