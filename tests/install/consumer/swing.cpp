// Pushes a pendulum to and fro.
#include <cnoid/SimpleController>
#include <rehearse_variable.h>

#include <cmath>

class Swing : public cnoid::SimpleController {
  cnoid::Link* hinge = nullptr;
  cnoid::SimpleControllerIO* io = nullptr;

 public:
  bool initialize(cnoid::SimpleControllerIO* given) override {
    io = given;
    hinge = io->body()->joint(0);
    hinge->setActuationMode(cnoid::Link::JointTorque);
    io->enableIO(hinge);
    return true;
  }

  bool control() override {
    rehearse_variable("angle seen", hinge->q());  // [rad]
    hinge->u() = 0.5 * std::sin(3.0 * io->currentTime()) - 0.1 * hinge->q();
    return true;
  }
};

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Swing)
