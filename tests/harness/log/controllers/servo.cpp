// Holds each joint at 0.5 rad, with one kind of memory: none, a filtered derivative, or an integral. Its option is a
// factor of its commands. It records its state as variables, and takes it back.
#include <rehearse_state.h>
#include <rehearse_variable.h>

#include <cnoid/SimpleController>

#include <string>
#include <vector>

namespace {

enum class Memory { none, filtered, integral };

class Servo : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    dt_ = io->timeStep();
    if (!io->optionString().empty()) scale_ = std::stod(io->optionString());
    for (cnoid::Link* joint : io->body()->joints()) {
      joint->setActuationMode(cnoid::Link::JointEffort);
      io->enableOutput(joint);
      io->enableInput(joint, cnoid::Link::JointDisplacement | cnoid::Link::JointVelocity);
      axes_.push_back({joint, joint->jointName() + "/last", joint->jointName() + "/state"});
    }
    return true;
  }

  bool start() override {
    for (Axis& axis : axes_) {
      if (TAKEN_NUMBERS > 0 && rehearse_state(axis.name_of_last.c_str(), &axis.last)) is_first_ = false;
      if (TAKEN_NUMBERS > 1) rehearse_state(axis.name_of_state.c_str(), &axis.state);
    }
    return true;
  }

  bool control() override {
    for (Axis& axis : axes_) {
      const double q = axis.joint->q();
      double u = 40.0 * (0.5 - q) - 1.5 * axis.joint->dq();
      if (Memory::MEMORY == Memory::filtered) {
        if (is_first_) axis.last = q;
        axis.state += 0.2 * ((q - axis.last) / dt_ - axis.state);
        u = 40.0 * (0.5 - q) - 1.5 * axis.state;
        axis.last = q;
      }
      if (Memory::MEMORY == Memory::integral) {
        axis.state += 20.0 * (0.5 - q) * dt_;
        u += axis.state;
      }
      axis.joint->u() = scale_ * u;
      rehearse_variable(axis.name_of_last.c_str(), axis.last);
      rehearse_variable(axis.name_of_state.c_str(), axis.state);
    }
    is_first_ = false;
    return true;
  }

 private:
  struct Axis {
    cnoid::Link* joint;
    std::string name_of_last, name_of_state;
    double last = 0.0, state = 0.0;
  };
  std::vector<Axis> axes_;
  double dt_ = 0.0, scale_ = 1.0;
  bool is_first_ = true;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(Servo)
