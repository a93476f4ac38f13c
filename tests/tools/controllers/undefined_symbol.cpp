// A controller with an undefined symbol: no library defines gait_phase().
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
