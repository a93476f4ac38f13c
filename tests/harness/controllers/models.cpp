// Controllers that load a model of their own, and compute with it.
#include <cnoid/BodyLoader>
#include <cnoid/InverseDynamics>
#include <cnoid/SimpleController>

#include <cmath>
#include <string>
#include <vector>

#include "behaviours.h"

namespace behaviours {
namespace {

/// computed_torque FILE: loads the body's model, and commands the efforts that give each joint the acceleration
/// 2 cos(4 t) [rad/s²], for the displacements and velocities that it reads.
class ComputedTorque : public cnoid::SimpleController {
 public:
  explicit ComputedTorque(const Words& words) : file_(words.at(0)) {}
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    io->setNoDelayMode(true);
    cnoid::BodyLoader loader;
    loader.setMessageSink(io->os());
    model_ = loader.load(file_);
    if (!model_) return false;
    model_->rootLink()->T() = io->body()->rootLink()->T();
    for (const auto& joint : io->body()->joints()) {
      joint->setActuationMode(cnoid::Link::JointEffort);
      io->enableIO(joint);
      io->enableInput(joint, cnoid::Link::JointVelocity);
    }
    return true;
  }
  bool control() override {
    for (int id = 0; id < model_->numJoints(); ++id) {
      model_->joint(id)->q() = io_->body()->joint(id)->q();
      model_->joint(id)->dq() = io_->body()->joint(id)->dq();
      model_->joint(id)->ddq() = 2.0 * std::cos(4.0 * io_->currentTime());
    }
    model_->rootLink()->dv() = cnoid::Vector3(0, 0, 9.80665);
    model_->calcForwardKinematics(true);
    cnoid::calcInverseDynamics(model_->rootLink());
    for (int id = 0; id < model_->numJoints(); ++id) io_->body()->joint(id)->u() = model_->joint(id)->u();
    return true;
  }

 private:
  std::string file_;
  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::BodyPtr model_;
};
const Add<ComputedTorque> computed_torque("computed_torque");

}  // namespace
}  // namespace behaviours
