// Lets SR1 squat: its joints follow a motion from a .seq file, each by a proportional-derivative torque.
//
// The motion advances only while the feet carry the robot: if the robot is lifted, the motion pauses.
//
// Option: the motion's file, relative to the share folder.

#include <cnoid/ForceSensor>
#include <cnoid/SimpleController>

#include "JointMotion.h"

namespace {

constexpr double gravity = 9.80665;  // [m/s²]
constexpr double p_gain = 8000.0;    // [N·m/rad]
constexpr double d_gain = 60.0;      // [N·m·s/rad]

class SR1SquatController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    body_ = io->body();
    time_step_ = io->timeStep();
    if (!motion_.load(io->optionString(), io)) return false;
    for (cnoid::Link* joint : body_->joints()) {
      joint->setActuationMode(JointTorque);
      io->enableInput(joint, JointAngle | JointVelocity);
      io->enableOutput(joint);
    }
    feet_ = body_->devices();
    for (cnoid::ForceSensor* foot : feet_) io->enableInput(foot);
    return true;
  }

  bool control() override {
    const double time = ticks_ * time_step_;
    for (cnoid::Link* joint : body_->joints()) {
      const JointReference wanted = motion_.at(joint->jointId(), time);
      joint->u() = p_gain * (wanted.q - joint->q()) + d_gain * (wanted.dq - joint->dq());
    }
    if (stands()) ++ticks_;
    return motion_.continues(time);
  }

 private:
  /// True if the feet carry most of the weight.
  bool stands() const {
    double force = 0.0;  // [N]
    for (const cnoid::ForceSensor* foot : feet_) force += foot->f().z();
    return force > 0.5 * gravity * body_->mass();
  }

  cnoid::BodyPtr body_;
  double time_step_ = 0.0;  // [s]
  JointMotion motion_;
  cnoid::DeviceList<cnoid::ForceSensor> feet_;
  int ticks_ = 0;  // of the motion
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SR1SquatController)
