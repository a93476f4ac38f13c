// A controller whose author forgot to link a library: gait_phase() is nowhere.
#include <cnoid/SimpleController>

double gait_phase(double time);

namespace {

class Unlinked : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO*) override { return true; }
  bool control() override { return gait_phase(0.0) > 0.0; }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Unlinked)
