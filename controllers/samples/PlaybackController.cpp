// Plays a motion back without dynamics: the root link follows the motion's LinkPosition, the joints follow its
// JointDisplacement. For a body that is kinematic in the scenario.
//
// Between two frames positions and angles are interpolated linearly, rotations about a fixed axis. Joints that mimic
// others need no commands.
//
// Option: the motion's file, relative to the share folder.

#include <algorithm>
#include <cmath>
#include <cnoid/BodyMotion>
#include <cnoid/ExecutablePath>
#include <cnoid/SimpleController>
#include <memory>

namespace {

class PlaybackController : public cnoid::SimpleController {
 public:
  bool initialize(cnoid::SimpleControllerIO* io) override {
    io_ = io;
    root_ = io->body()->rootLink();
    cnoid::BodyMotion motion;
    if (!motion.load((cnoid::shareDirPath() / io->optionString()).string(), io->os())) return false;
    motion.updateJointPosSeqWithBodyStateSeq();
    motion.updateLinkPosSeqWithBodyStateSeq();
    joints_ = motion.jointPosSeq();
    links_ = motion.linkPosSeq();
    if (joints_->numParts() > io->body()->numJoints() || links_->numParts() < 1) {
      io->os() << "the motion is of another robot than " << io->body()->modelName() << "\n";
      return false;
    }
    io->setNoDelayMode(true);  // so that the body has the motion's pose of a step at the end of the same step
    io->enableOutput(root_, LinkPosition);
    for (int id = 0; id < joints_->numParts(); ++id) io->enableOutput(io->body()->joint(id), JointDisplacement);
    return true;
  }

  bool control() override {
    const double frame = (io_->currentTime() + io_->timeStep()) * joints_->frameRate();
    const int k = static_cast<int>(std::floor(frame));
    const double s = frame - k;
    for (int id = 0; id < joints_->numParts(); ++id) {
      const double before = joints_->clampedFrame(k)[id];
      io_->body()->joint(id)->q_target() = before + s * (joints_->clampedFrame(k + 1)[id] - before);
    }
    const cnoid::SE3 before = links_->clampedFrame(k)[0];
    const cnoid::SE3 after = links_->clampedFrame(k + 1)[0];
    root_->setTranslation(before.translation() + s * (after.translation() - before.translation()));
    root_->setRotation(before.rotation().slerp(s, after.rotation()));
    return k < joints_->numFrames() - 1;
  }

 private:
  cnoid::SimpleControllerIO* io_ = nullptr;
  cnoid::Link* root_ = nullptr;
  std::shared_ptr<cnoid::MultiValueSeq> joints_;
  std::shared_ptr<cnoid::MultiSE3Seq> links_;
};

}  // namespace

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(PlaybackController)
