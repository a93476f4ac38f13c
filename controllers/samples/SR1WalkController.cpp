// Lets SR1 walk: its joints follow the walking pattern of a .seq file (tools/make_walk makes it), by torque, by
// velocity or by displacement.
//
// The pattern alone carries SR1 over a flat floor. In the pattern the waist stays upright, so each turn of the waist
// that its gyro measures is an error. The ankles turn against it: that damps the swaying on slopes and after pushes.
// A displacement drive is so stiff that it would shake the feet with it.
//
// Options: "{motion: motion/sr1_walk.seq, mode: torque}": the file, relative to the share folder; torque, velocity or
// displacement.

#include <array>
#include <cnoid/RateGyroSensor>
#include <cnoid/SimpleController>
#include <string>

#include "JointMotion.h"

namespace {

constexpr double p_gain = 8000.0;       // [N·m/rad]
constexpr double d_gain = 100.0;        // [N·m·s/rad]
constexpr double velocity_gain = 50.0;  // of displacement, if velocities drive the joints [1/s]
constexpr double ankle_damping = 0.05;  // of the ankle by the waist's angular velocity [s]

class SR1WalkController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    body_ = io->body();
    time_step_ = io->timeStep();
    gyro_ = body_->findDevice<cnoid::RateGyroSensor>();
    const cnoid::MappingPtr options = io->structuredOptions();
    std::string file, mode;
    if (!options || !options->read("motion", file) || !options->read("mode", mode) || !set_actuation(mode) || !gyro_ ||
        !find_ankles()) {
      io->os() << io->controllerName() << " needs SR1's ankles and a gyro, and the options motion (a file) and mode "
               << "(torque, velocity or displacement)\n";
      return false;
    }
    if (!motion_.load(file, io)) return false;
    for (cnoid::Link* joint : body_->joints()) {
      joint->setActuationMode(actuation_);
      io->enableInput(joint, JointAngle | JointVelocity);
      io->enableOutput(joint);
    }
    io->enableInput(gyro_);
    return true;
  }

  bool control() override {
    const double time = ticks_++ * time_step_;
    for (cnoid::Link* joint : body_->joints()) {
      JointReference wanted = motion_.at(joint->jointId(), time);
      for (const Ankle& ankle : ankles_)
        if (joint == ankle.joint && actuation_ != JointDisplacement) wanted.q += ankle_damping * gyro_->w()[ankle.axis];
      const double error = wanted.q - joint->q();
      switch (actuation_) {
        case JointDisplacement: joint->q_target() = wanted.q; break;
        case JointVelocity: joint->dq_target() = wanted.dq + velocity_gain * error; break;
        default: joint->u() = p_gain * error + d_gain * (wanted.dq - joint->dq());
      }
    }
    return motion_.continues(time);
  }

 private:
  struct Ankle {
    const char* name;
    int axis;  // of the waist about which it turns the foot: 0: x, 1: y
    cnoid::Link* joint = nullptr;
  };

  bool set_actuation(const std::string& mode) {
    if (mode == "torque") actuation_ = JointTorque;
    if (mode == "velocity") actuation_ = JointVelocity;
    if (mode == "displacement") actuation_ = JointDisplacement;
    return actuation_ != 0;
  }

  bool find_ankles() {
    for (Ankle& ankle : ankles_) {
      ankle.joint = body_->joint(ankle.name);
      if (!ankle.joint) return false;
    }
    return true;
  }

  cnoid::BodyPtr body_;
  double time_step_ = 0.0;  // [s]
  cnoid::RateGyroSensor* gyro_ = nullptr;
  std::array<Ankle, 4> ankles_{{{"LLEG_ANKLE_P", 1}, {"LLEG_ANKLE_R", 0}, {"RLEG_ANKLE_P", 1}, {"RLEG_ANKLE_R", 0}}};
  JointMotion motion_;
  int actuation_ = 0;
  int ticks_ = 0;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SR1WalkController)
