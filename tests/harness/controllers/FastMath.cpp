// Linked with -ffast-math, whose start-up code flushes denormal numbers in the thread that loads the library.
#include <cnoid/SimpleController>

namespace {

class FastMath : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO*) override { return true; }
  bool control() override { return true; }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(FastMath)
