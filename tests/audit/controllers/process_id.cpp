// Seeds its dither with the number of its process.
#include "zoo.h"

#include <unistd.h>

namespace {

class ProcessId : public ZooController {
  double term() override { return 1e-9 * static_cast<double>(getpid()); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ProcessId)
