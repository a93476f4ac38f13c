// Holds SR1 in the posture in which it starts: a proportional-derivative torque controller for each of its 29 joints.

#include <cnoid/SimpleController>
#include <cstddef>
#include <iterator>
#include <vector>

namespace {

// By joint id: right leg (6), right arm (7), left leg (6), left arm (7), waist (3).
constexpr double p_gain[] = {                                // [N·m/rad]
    8000.0, 8000.0, 8000.0, 8000.0, 8000.0, 8000.0,          //
    3000.0, 3000.0, 3000.0, 3000.0, 3000.0, 3000.0, 3000.0,  //
    8000.0, 8000.0, 8000.0, 8000.0, 8000.0, 8000.0,          //
    3000.0, 3000.0, 3000.0, 3000.0, 3000.0, 3000.0, 3000.0,  //
    8000.0, 8000.0, 8000.0};
constexpr double d_gain = 100.0;  // [N·m·s/rad], the same for all

class SR1MinimumController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    body_ = io->body();
    time_step_ = io->timeStep();
    if (body_->numJoints() > static_cast<int>(std::size(p_gain))) {
      io->os() << io->controllerName() << ": " << body_->modelName() << " has " << body_->numJoints()
               << " joints, but there are gains for " << std::size(p_gain) << " only\n";
      return false;
    }
    for (cnoid::Link* joint : body_->joints()) {
      joint->setActuationMode(cnoid::Link::JointTorque);
      io->enableIO(joint);
      q_reference_.push_back(joint->q());
    }
    q_before_ = q_reference_;
    return true;
  }

  bool control() override {
    for (std::size_t i = 0; i < q_before_.size(); ++i) {
      cnoid::Link* joint = body_->joint(static_cast<int>(i));
      const double q = joint->q();
      const double dq = (q - q_before_[i]) / time_step_;
      joint->u() = (q_reference_[i] - q) * p_gain[i] + (0.0 - dq) * d_gain;
      q_before_[i] = q;
    }
    return true;
  }

 private:
  cnoid::BodyPtr body_;
  double time_step_ = 0.0;           // [s]
  std::vector<double> q_reference_;  // [rad]
  std::vector<double> q_before_;     // in the last step [rad]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SR1MinimumController)
