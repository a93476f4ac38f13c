// Holds joint SHOULDER at 0 with a proportional-derivative law. Compiled a second time with CHANGED_FROM_TICK, whose
// gain is 1 % higher from that tick on. A third time with EFFORT_GAIN: it also reads the effort.

#include <cnoid/SimpleController>

namespace {

class HingePd : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    joint_ = io->body()->joint("SHOULDER");
    joint_->setActuationMode(cnoid::Link::JointEffort);
    io->enableIO(joint_);
    io->enableInput(joint_, cnoid::Link::JointVelocity);
#ifdef EFFORT_GAIN
    io->enableInput(joint_, cnoid::Link::JointEffort);
#endif
    return true;
  }
  bool control() override {
    double gain = 50.0;  // [N·m/rad]
#ifdef CHANGED_FROM_TICK
    if (tick_ >= CHANGED_FROM_TICK) gain *= 1.01;
#endif
    ++tick_;
#ifdef EFFORT_GAIN
    const double read = EFFORT_GAIN * joint_->u();
#else
    const double read = 0.0;
#endif
    joint_->u() = read - gain * joint_->q() - 2.0 * joint_->dq();
    return true;
  }

 private:
  cnoid::Link* joint_ = nullptr;
  int tick_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(HingePd)
