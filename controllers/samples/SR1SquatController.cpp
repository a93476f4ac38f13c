// Lets SR1 squat: its joints follow a motion from a .seq file, each by a proportional-derivative torque.
//
// The motion has a few frames per second. Between them each joint follows a cubic through the frames (Catmull and Rom's
// spline), so that its speed, which the torque also follows, has no jumps. The motion advances only while the feet
// carry the robot: if the robot is lifted, the motion pauses.
//
// Option: the motion's file, relative to the share folder.

#include <cmath>
#include <cnoid/BodyMotion>
#include <cnoid/ExecutablePath>
#include <cnoid/ForceSensor>
#include <cnoid/SimpleController>
#include <memory>

namespace {

constexpr double gravity = 9.80665;  // [m/s²]
constexpr double p_gain = 8000.0;    // [N·m/rad]
constexpr double d_gain = 60.0;      // [N·m·s/rad]

/// The planned state of a joint at a time.
struct Reference {
  double q;   // [rad]
  double dq;  // [rad/s]
};

class SR1SquatController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    body_ = io->body();
    time_step_ = io->timeStep();
    cnoid::BodyMotion motion;
    if (!motion.load((cnoid::shareDirPath() / io->optionString()).string(), io->os())) return false;
    motion.updateJointPosSeqWithBodyStateSeq();
    motion_ = motion.jointPosSeq();
    if (motion_->numParts() != body_->numJoints()) {
      io->os() << "the motion has " << motion_->numParts() << " joints, " << body_->modelName() << " has "
               << body_->numJoints() << "\n";
      return false;
    }
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
    const double frame = ticks_ * time_step_ * motion_->frameRate();
    for (cnoid::Link* joint : body_->joints()) {
      const Reference wanted = reference(joint->jointId(), frame);
      joint->u() = p_gain * (wanted.q - joint->q()) + d_gain * (wanted.dq - joint->dq());
    }
    if (stands()) ++ticks_;
    return frame < motion_->numFrames() - 1;
  }

 private:
  /// True if the feet carry most of the weight.
  bool stands() const {
    double force = 0.0;  // [N]
    for (const cnoid::ForceSensor* foot : feet_) force += foot->f().z();
    return force > 0.5 * gravity * body_->mass();
  }

  Reference reference(int joint, double frame) const {
    const int k = static_cast<int>(std::floor(frame));
    const double s = frame - k;
    const double q0 = motion_->clampedFrame(k)[joint];
    const double q1 = motion_->clampedFrame(k + 1)[joint];
    const double slope0 = 0.5 * (q1 - motion_->clampedFrame(k - 1)[joint]);  // [rad/frame]
    const double slope1 = 0.5 * (motion_->clampedFrame(k + 2)[joint] - q0);
    const double c2 = 3.0 * (q1 - q0) - 2.0 * slope0 - slope1;
    const double c3 = -2.0 * (q1 - q0) + slope0 + slope1;
    return {q0 + s * (slope0 + s * (c2 + s * c3)), motion_->frameRate() * (slope0 + s * (2.0 * c2 + s * 3.0 * c3))};
  }

  cnoid::BodyPtr body_;
  double time_step_ = 0.0;  // [s]
  std::shared_ptr<cnoid::MultiValueSeq> motion_;
  cnoid::DeviceList<cnoid::ForceSensor> feet_;
  int ticks_ = 0;  // of the motion
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(SR1SquatController)
