// Raises an arm and lowers it again: a parent controller. Its child, ChildController, keeps the tray at the end of the
// arm level. They share one body and the parent's data about the tray; each function of the parent is called before
// that of the child.
//
// The load on the tray is not given: the parent weighs it by the force at the wrist, and sets the shoulder's torque
// accordingly. The weighing is slow; otherwise the torque would respond to forces that it causes itself.
//
// Options: "{raise: 60, period: 2}": the angle [deg], and the duration of up and down together [s].

#include <algorithm>
#include <cmath>
#include <cnoid/ForceSensor>
#include <cnoid/MathUtil>
#include <cnoid/SimpleController>

#include "ParentAndChild.h"

namespace {

constexpr double gravity = 9.80665;    // [m/s²]
constexpr double p_gain = 60.0;        // [N·m/rad]
constexpr double d_gain = 8.0;         // [N·m·s/rad]
constexpr double weighing_time = 0.2;  // [s]
constexpr double rest_time = 0.8;      // after this time the arm is at rest and the load is weighed [s]

class ParentController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    shoulder_ = io->body()->joint("SHOULDER");
    wrist_ = io->body()->joint("WRIST");
    scale_ = io->body()->findDevice<cnoid::ForceSensor>("WristForce");
    const cnoid::MappingPtr options = io->structuredOptions();
    if (!shoulder_ || !wrist_ || !scale_ || !options || !options->read("raise", raise_) ||
        !options->read("period", period_)) {
      io->os() << io->controllerName() << " needs joints SHOULDER and WRIST, a sensor WristForce, "
               << "and the options raise [deg] and period [s]\n";
      return false;
    }
    shoulder_->setActuationMode(JointTorque);
    io->enableInput(shoulder_, JointAngle | JointVelocity);
    io->enableOutput(shoulder_);
    io->enableInput(scale_);
    tray_ = io->getOrCreateSharedObject<TrayState>(TrayState::name);
    return true;
  }

  bool start() override {
    lowest_ = shoulder_->q();
    tray_->load = wrist_->m();  // initial value
    return true;
  }

  bool control() override {
    weigh();
    const double time = std::min(io_->currentTime(), period_);
    const double frequency = 2.0 * cnoid::PI / period_;  // [rad/s]
    const double half = 0.5 * cnoid::radian(raise_);
    const double angle = lowest_ - half * (1.0 - std::cos(frequency * time));  // up is negative
    const double rate = -half * frequency * std::sin(frequency * time);
    shoulder_->u() = p_gain * (angle - shoulder_->q()) + d_gain * (rate - shoulder_->dq()) - torque_of_weights();

    if (io_->currentTime() >= period_ + rest_time && !tray_->has_arrived) {
      tray_->has_arrived = true;
      io_->os() << "there are " << tray_->load - wrist_->m() << " kg on the tray\n";
    }
    return !tray_->has_arrived;
  }

 private:
  /// The sensor reads zero in the first step, before its first measurement.
  void weigh() {
    if (io_->currentTime() == 0.0) return;
    const double measured = -scale_->f().z() / gravity;  // the tray presses down
    tray_->load += io_->timeStep() / weighing_time * (measured - tray_->load);
  }

  /// The load's torque about the shoulder [N·m].
  double torque_of_weights() const {
    const double moment = shoulder_->m() * shoulder_->c().x() + tray_->load * wrist_->b().x();  // [kg·m]
    return gravity * moment * std::cos(shoulder_->q());
  }

  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* shoulder_ = nullptr;
  cnoid::Link* wrist_ = nullptr;
  cnoid::ForceSensor* scale_ = nullptr;
  TrayState* tray_ = nullptr;
  double raise_ = 0.0;   // [deg]
  double period_ = 0.0;  // [s]
  double lowest_ = 0.0;  // initial angle [rad]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ParentController)
