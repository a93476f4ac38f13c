// Moves all joints of a body along sums of sines, by efforts with a proportional-derivative law. Its option is a factor
// of their amplitudes; 0 leaves the joints without effort; q commands the sums themselves as displacements.

#include <cnoid/SimpleController>

#include <cmath>
#include <cstdlib>
#include <string>

namespace {

class Shaker : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    body_ = io->body();
    const std::string option = io->optionString();
    commands_displacements_ = option == "q";
    amplitude_ = option.empty() ? 1.0 : std::atof(option.c_str());
    step_ = io->timeStep();
    for (int i = 0; i < body_->numJoints(); ++i) {
      body_->joint(i)->setActuationMode(commands_displacements_ ? cnoid::Link::JointDisplacement
                                                                : cnoid::Link::JointEffort);
      io->enableIO(body_->joint(i));
      io->enableInput(body_->joint(i), cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
    }
    return true;
  }
  bool control() override {
    const double time = step_ * tick_++;
    for (int i = 0; i < body_->numJoints(); ++i) {
      cnoid::Link* const joint = body_->joint(i);
      const double fast = 7.0 + 2.0 * i, slow = 2.0 + i;  // [rad/s]
      const double wanted = 0.5 * std::sin(slow * time) + 0.2 * std::sin(fast * time + i);
      const double velocity = 0.5 * slow * std::cos(slow * time) + 0.2 * fast * std::cos(fast * time + i);
      if (commands_displacements_) {
        joint->q_target() = wanted;
        continue;
      }
      joint->u() = amplitude_ == 0.0
                       ? 0.0
                       : 15.0 * (amplitude_ * wanted - joint->q()) + 1.5 * (amplitude_ * velocity - joint->dq());
    }
    return true;
  }

 private:
  cnoid::Body* body_ = nullptr;
  bool commands_displacements_ = false;
  double amplitude_ = 1.0;
  double step_ = 0.001;
  int tick_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Shaker)
