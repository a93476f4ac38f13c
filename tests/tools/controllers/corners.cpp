// Holds a pendulum at an angle, with a fault that shows only in a corner of the space of its options and of its motion.
// Options: "{stiffness: 60, damping: 6, ramp: 0.05, limit: 80, gain: 1, offset: 0, fault: 0}". The limit is that of the
// torque [N·m]; fault 0 is none. Each of the others depends on two or three parameters of the scenario.
#include <cnoid/SimpleController>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace {

class Corners : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    hinge_ = io->body()->joint("hinge");
    hinge_->setActuationMode(JointTorque);
    io->enableIO(hinge_);
    const cnoid::MappingPtr options = io->structuredOptions();
    for (const auto& [name, value] : {std::pair("stiffness", &stiffness_),
                                      {"damping", &damping_},
                                      {"ramp", &ramp_},
                                      {"limit", &limit_},
                                      {"gain", &gain_},
                                      {"offset", &offset_}})
      options->read(name, *value);
    fault_ = options->get("fault", 0);
    last_ = hinge_->q();
    return true;
  }

  bool control() override {
    time_ += io_->timeStep();
    const double q = hinge_->q(), speed = (q - last_) / io_->timeStep();
    last_ = q;
    const double share = ramp_ > 0.0 ? std::min(time_ / ramp_, 1.0) : 1.0;
    double torque = share * gain_ * (stiffness_ * (offset_ - q) - damping_ * speed);
    torque = std::clamp(torque, -limit_, limit_);
    if (is_in_corner(q, speed)) torque = wrong(torque);
    hinge_->u() = torque;
    return true;
  }

 private:
  bool is_in_corner(double q, double speed) const {
    switch (fault_) {
      case 1: return stiffness_ > 85.0 && damping_ < 3.0;
      case 2: return ramp_ > 0.08 && limit_ < 65.0;
      case 3: return gain_ > 1.15 && stiffness_ > 80.0;
      case 4: return std::abs(q) > 0.25 && time_ < 0.01 && stiffness_ < 45.0;  // released far away, and weak
      case 5: return offset_ > 0.07 && damping_ > 9.0;
      case 6: return time_ > 0.25 && speed > 2.5 && limit_ < 70.0;  // pushed hard
      case 7: return ramp_ < 0.02 && gain_ < 0.85;
      case 8: return time_ > 0.25 && q - offset_ > 0.15 && damping_ < 4.0;  // pushed, and hardly damped
      case 9: return offset_ < -0.06 && ramp_ > 0.07 && time_ > 0.1;
      case 10: return gain_ > 1.1 && offset_ > 0.05 && time_ > 0.25;
      default: return false;
    }
  }

  double wrong(double torque) const {
    switch (fault_) {
      case 1:
      case 5: throw std::runtime_error("no solution");
      case 2: return 100.0;
      case 3: return -110.0;
      case 4: return 150.0;
      case 6: std::abort();
      case 7: io_->os() << "error: out of range" << std::endl; return torque;
      case 8: return 120.0;
      case 9: return -130.0;
      default: return 110.0;
    }
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* hinge_ = nullptr;
  double stiffness_ = 60.0, damping_ = 6.0, ramp_ = 0.05, limit_ = 80.0, gain_ = 1.0, offset_ = 0.0;
  int fault_ = 0;
  double last_ = 0.0, time_ = 0.0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Corners)
