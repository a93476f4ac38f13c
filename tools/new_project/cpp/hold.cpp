// Holds the arm at the angle where it starts, or at the one in its options [rad], against gravity and pushes.
#include <cnoid/SimpleController>

#include <string>

class Hold : public cnoid::SimpleController {
  static constexpr double stiffness = 60.0;  // [N·m/rad]
  static constexpr double damping = 6.0;     // [N·m·s/rad]

  cnoid::Link* shoulder_ = nullptr;
  double target_ = 0.0;  // [rad]

 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    shoulder_ = io->body()->joint("SHOULDER");
    if (!shoulder_) {
      io->os() << "the robot has no joint SHOULDER\n";
      return false;
    }
    shoulder_->setActuationMode(cnoid::Link::JointEffort);
    io->enableOutput(shoulder_);
    io->enableInput(shoulder_, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);

    const auto options = io->options();
    target_ = options.empty() ? shoulder_->q() : std::stod(options[0]);
    return true;
  }

  bool control() override {
    shoulder_->u() = stiffness * (target_ - shoulder_->q()) - damping * shoulder_->dq();
    return true;
  }
};

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Hold)
