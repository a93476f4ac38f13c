// Keeps the tray of an arm level: the child of ParentController. It drives only the wrist, but also reads the
// shoulder's angle: it shares the body with its parent, which has enabled that input.
//
// Its stiffness is proportional to the load, which the parent has weighed.
//
// Options: "{stiffness: 15, damping: 1}", for each kilogram of load [N·m/rad/kg], [N·m·s/rad/kg].

#include <cnoid/RateGyroSensor>
#include <cnoid/SimpleController>

#include "ParentAndChild.h"

namespace {

class ChildController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    shoulder_ = io->body()->joint("SHOULDER");
    wrist_ = io->body()->joint("WRIST");
    gyro_ = io->body()->findDevice<cnoid::RateGyroSensor>("TrayGyro");
    const cnoid::MappingPtr options = io->structuredOptions();
    if (!shoulder_ || !wrist_ || !gyro_ || !options || !options->read("stiffness", stiffness_) ||
        !options->read("damping", damping_)) {
      io->os() << io->controllerName() << " needs joints SHOULDER and WRIST, a sensor TrayGyro, "
               << "and the options stiffness [N·m/rad/kg] and damping [N·m·s/rad/kg]\n";
      return false;
    }
    wrist_->setActuationMode(JointTorque);
    io->enableIO(wrist_);
    io->enableInput(gyro_);
    return true;
  }

  bool start() override {
    tray_ = io_->findSharedObject<TrayState>(TrayState::name);
    if (!tray_)
      io_->os() << io_->controllerName() << " is to be a child of ParentController: nobody tells it the load\n";
    return tray_ != nullptr;
  }

  bool control() override {
    const double tilt = shoulder_->q() + wrist_->q();
    wrist_->u() = -tray_->load * (stiffness_ * tilt + damping_ * gyro_->w().y());
    return !tray_->has_arrived;
  }

 private:
  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* shoulder_ = nullptr;
  cnoid::Link* wrist_ = nullptr;
  cnoid::RateGyroSensor* gyro_ = nullptr;
  TrayState* tray_ = nullptr;
  double stiffness_ = 0.0;  // [N·m/rad/kg]
  double damping_ = 0.0;    // [N·m·s/rad/kg]
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(ChildController)
