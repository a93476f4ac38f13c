// A second controller as a user writes it, with more of Choreonoid's tools: its joints follow a motion, inverse
// kinematics keeps its hand at the start pose, and a joystick scales both.

#include <cnoid/BodyMotion>
#include <cnoid/EigenUtil>
#include <cnoid/ExecutablePath>
#include <cnoid/FileUtil>
#include <cnoid/HolderDevice>
#include <cnoid/JointPath>
#include <cnoid/SharedJoystick>
#include <cnoid/SimpleController>

using namespace std;
using namespace cnoid;

class UserMotionController : public SimpleController {
  BodyPtr ioBody;
  BodyPtr ikBody;
  std::shared_ptr<JointPath> path;
  std::shared_ptr<MultiValueSeq> qseq;
  std::shared_ptr<MultiSE3Seq> poses;
  MultiValueSeq::Frame qref;
  SharedJoystickPtr joystick;
  int mode;
  HolderDevice* holder;
  int frame;
  Isometry3 hand;

 public:
  virtual bool initialize(SimpleControllerIO* io) override {
    ioBody = io->body();
    auto file = shareDirPath() / "version2.seq";
    BodyMotion motion;
    if (!motion.load(file.make_preferred().string())) {
      io->os() << motion.seqMessage() << endl;
      return false;
    }
    motion.updateJointPosSeqWithBodyStateSeq();
    qseq = motion.jointPosSeq();
    poses = motion.linkPosSeq();
    if (qseq->numParts() != ioBody->numJoints()) {
      io->os() << "The number of joints must be " << qseq->numParts() << endl;
      return false;
    }
    qref = qseq->frame(0);
    frame = 0;

    ikBody = ioBody->clone();
    path = JointPath::getCustomPath(ikBody->rootLink(), ikBody->link("HAND"));
    path->calcForwardKinematics();
    hand = path->endLink()->T();

    joystick = io->getOrCreateSharedObject<SharedJoystick>("joystick");
    mode = joystick->addMode();
    holder = ioBody->findDevice<HolderDevice>();
    return holder;
  }

  virtual bool control() override {
    joystick->updateState(mode);
    double scale = 1.0 + joystick->getPosition(mode, Joystick::L_STICK_V_AXIS, 0.1);
    for (auto joint : ioBody->joints()) joint->q_target() = scale * qref[joint->jointId()];
    qref = qseq->clampedFrame(++frame);

    bool solved = path->calcInverseKinematics(hand);
    const SE3& pose = poses->frame(2)[0];
    ioBody->rootLink()->dq_target() = solved ? pose.translation().x() + degree(rpyFromRot(hand.linear()).z()) : -1.0;
    holder->on(joystick->getButtonState(mode, Joystick::A_BUTTON));
    holder->info()->write("grip", holder->info()->get("grip", 0.0) + 0.25);
    holder->notifyStateChange();
    holder->notifyInfoChange();
    return frame < qseq->numFrames();
  }
};

CNOID_IMPLEMENT_SIMPLE_CONTROLLER_FACTORY(UserMotionController)
