// Code that SR1's squat and SR1's walk share: the motion of a .seq file, as a smooth function of time for each joint.
//
// The file has a few frames per second. Between them each joint follows a cubic through the frames (Catmull and Rom's
// spline), so that its speed has no jumps.
#pragma once

#include <cmath>
#include <cnoid/BodyMotion>
#include <cnoid/ExecutablePath>
#include <cnoid/SimpleController>
#include <memory>
#include <string>

/// The planned state of a joint at a time.
struct JointReference {
  double q;   // [rad]
  double dq;  // [rad/s]
};

class JointMotion {
 public:
  /// Reads `file`, relative to the share folder. False, with a message, if that fails or if the motion has another
  /// number of joints than the robot.
  bool load(const std::string& file, cnoid::SimpleControllerIO* io) {
    cnoid::BodyMotion motion;
    if (!motion.load((cnoid::shareDirPath() / file).string(), io->os())) return false;
    motion.updateJointPosSeqWithBodyStateSeq();
    frames_ = motion.jointPosSeq();
    if (frames_->numParts() == io->body()->numJoints()) return true;
    io->os() << "the motion has " << frames_->numParts() << " joints, " << io->body()->modelName() << " has "
             << io->body()->numJoints() << "\n";
    return false;
  }

  /// True if the motion has a later frame than that at `time` [s].
  bool continues(double time) const { return time * frames_->frameRate() < frames_->numFrames() - 1; }

  JointReference at(int joint, double time) const {
    const double frame = time * frames_->frameRate();
    const int k = static_cast<int>(std::floor(frame));
    const double s = frame - k;
    const double q0 = frames_->clampedFrame(k)[joint];
    const double q1 = frames_->clampedFrame(k + 1)[joint];
    const double slope0 = 0.5 * (q1 - frames_->clampedFrame(k - 1)[joint]);  // [rad/frame]
    const double slope1 = 0.5 * (frames_->clampedFrame(k + 2)[joint] - q0);
    const double c2 = 3.0 * (q1 - q0) - 2.0 * slope0 - slope1;
    const double c3 = -2.0 * (q1 - q0) + slope0 + slope1;
    return {q0 + s * (slope0 + s * (c2 + s * c3)), frames_->frameRate() * (slope0 + s * (2.0 * c2 + s * 3.0 * c3))};
  }

 private:
  std::shared_ptr<cnoid::MultiValueSeq> frames_;
};
