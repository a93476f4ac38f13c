// SR1 stoops and rises: a PD controller with a filter, and a state machine of three phases. stoop.c and stoop.rs
// compute the same, operation by operation.
#include <rehearse_variable.h>
#include <cnoid/SimpleController>

#include <cstdlib>
#include <vector>

namespace {

constexpr double stiffness = 8000.0;      // [N·m/rad]
constexpr double arm_stiffness = 3000.0;  // [N·m/rad]
constexpr double damping = 100.0;         // [N·m·s/rad]
constexpr double smoothing = 0.2;         // of the velocity filter, per step

class Stoop : public cnoid::SimpleController {
  struct Joint {
    cnoid::Link* link;
    double stiffness, bend, start, before, velocity;
  };
  std::vector<Joint> joints_;
  double time_step_ = 0.0;  // [s]
  double depth_ = 0.0;      // [rad]
  int tick_ = 0, phase_ = 0;

 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    time_step_ = io->timeStep();
    depth_ = std::strtod(io->optionString().c_str(), nullptr);
    for (cnoid::Link* link : io->body()->joints()) {
      const std::string& name = link->jointName();
      const bool is_arm = name.find("ARM") != std::string::npos;
      const double bend = name.find("KNEE") != std::string::npos                                                 ? 2.0
                          : name.find("HIP_P") != std::string::npos || name.find("ANKLE_P") != std::string::npos ? -1.0
                                                                                                                 : 0.0;
      io->enableInput(link, JointDisplacement);
      io->enableOutput(link, JointEffort);
      joints_.push_back({link, is_arm ? arm_stiffness : stiffness, bend, link->q(), link->q(), 0.0});
    }
    return true;
  }

  bool control() override {
    if (phase_ == 0 && tick_ == 100) phase_ = 1;
    if (phase_ == 1 && tick_ == 400) phase_ = 2;
    const double share = phase_ == 0 ? 0.0 : phase_ == 1 ? (tick_ - 100) / 300.0 : 1.0;
    rehearse_variable("phase", phase_);
    for (Joint& joint : joints_) {
      const double q = joint.link->q();
      joint.velocity += smoothing * ((q - joint.before) / time_step_ - joint.velocity);
      joint.before = q;
      const double target = joint.start + depth_ * joint.bend * share;
      joint.link->u() = joint.stiffness * (target - q) - damping * joint.velocity;
    }
    ++tick_;
    return true;
  }
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Stoop)
