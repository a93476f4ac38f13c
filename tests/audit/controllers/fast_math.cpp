// Its source is deterministic, but its library is linked with -ffast-math.
#include "zoo.h"

namespace {

class FastMath : public ZooController {
  double term() override { return -0.01 * joint_->q(); }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FastMath)
