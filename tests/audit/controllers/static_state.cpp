// Counts its calls in a static variable that is not reset between runs.
#include "zoo.h"

namespace {

class StaticState : public ZooController {
  double term() override {
    static int calls = 0;
    return 1e-6 * ++calls;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(StaticState)
