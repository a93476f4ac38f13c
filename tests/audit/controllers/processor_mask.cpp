// Its command depends on the number of processors on which it may run.
#include "zoo.h"

#include <sched.h>

namespace {

class ProcessorMask : public ZooController {
  double term() override {
    cpu_set_t set;
    CPU_ZERO(&set);
    sched_getaffinity(0, sizeof set, &set);
    return 1e-4 * CPU_COUNT(&set);
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ProcessorMask)
