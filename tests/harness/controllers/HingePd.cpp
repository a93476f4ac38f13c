// Holds joint SHOULDER at 0 with a proportional-derivative law. Compiled twice: CHANGED_FROM_TICK makes a copy whose
// gain is 1 % higher from that tick on.

#include <cnoid/SimpleController>

namespace {

class HingePd : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    joint_ = io->body()->joint("SHOULDER");
    joint_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(joint_);
    io->enableInput(joint_, cnoid::Link::JointVelocity);
    return true;
  }
  bool control() override {
    double gain = 50.0;  // [N·m/rad]
#ifdef CHANGED_FROM_TICK
    if (tick_ >= CHANGED_FROM_TICK) gain *= 1.01;
#endif
    ++tick_;
    joint_->u() = -gain * joint_->q() - 2.0 * joint_->dq();
    return true;
  }

 private:
  cnoid::Link* joint_ = nullptr;
  int tick_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(HingePd)
