// Its command depends on the parent process.
#include "zoo.h"

#include <unistd.h>

namespace {

class ParentProcess : public ZooController {
  double term() override { return 1e-9 * getppid(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ParentProcess)
