#include <algorithm>
#include <cnoid/Body>
#include <cnoid/BodyMotion>
#include <cnoid/ZMPSeq>
#include <stdexcept>

namespace cnoid {

const std::string& BodyMotion::linkPositionContentName() {
  static const std::string name = "LinkPosition";
  return name;
}

const std::string& BodyMotion::jointDisplacementContentName() {
  static const std::string name = "JointDisplacement";
  return name;
}

const std::string& BodyMotion::jointEffortContentName() {
  static const std::string name = "JointEffort";
  return name;
}

BodyMotion::BodyMotion() : AbstractSeq("CompositeSeq"), stateSeq_(std::make_shared<BodyStateSeq>()) {
  setSeqContentName("BodyMotion");
}

BodyMotion::BodyMotion(const BodyMotion& other)
    : AbstractSeq(other), stateSeq_(std::make_shared<BodyStateSeq>(*other.stateSeq_)) {
  copyExtraSeqs(other);
}

BodyMotion& BodyMotion::operator=(const BodyMotion& other) {
  if (this == &other) return *this;
  AbstractSeq::operator=(other);
  *stateSeq_ = *other.stateSeq_;
  copyExtraSeqs(other);
  sigExtraSeqsChanged_();
  return *this;
}

BodyMotion::~BodyMotion() = default;

std::shared_ptr<AbstractSeq> BodyMotion::cloneSeq() const { return std::make_shared<BodyMotion>(*this); }

void BodyMotion::copyExtraSeqs(const BodyMotion& other) {
  extraSeqs_.clear();
  for (const auto& entry : other.extraSeqs_) extraSeqs_[entry.first] = entry.second->cloneSeq();
}

// --- Rate, time and size: of the motion and of its additional sequences

void BodyMotion::setFrameRate(double rate) {
  stateSeq_->setFrameRate(rate);
  for (const auto& entry : extraSeqs_) entry.second->setFrameRate(rate);
}

void BodyMotion::setOffsetTime(double time) {
  stateSeq_->setOffsetTime(time);
  for (const auto& entry : extraSeqs_) entry.second->setOffsetTime(time);
}

void BodyMotion::setNumFrames(int n, bool fillNewElements) {
  stateSeq_->setNumFrames(n, fillNewElements);
  for (const auto& entry : extraSeqs_) entry.second->setNumFrames(n, fillNewElements);
}

void BodyMotion::setNumJoints(int numJoints, bool fillNewElements) {
  stateSeq_->setNumJointDisplacementsHint(numJoints);
  if (auto seq = extraSeq<MultiValueSeq>(jointDisplacementContentName())) seq->setNumParts(numJoints, fillNewElements);
}

void BodyMotion::setDimension(int numFrames, int numJoints, int numLinks, bool fillNewElements) {
  setNumFrames(numFrames, fillNewElements);
  setNumJoints(numJoints, fillNewElements);
  stateSeq_->setNumLinkPositionsHint(numLinks);
  if (auto seq = extraSeq<MultiSE3Seq>(linkPositionContentName())) seq->setNumParts(numLinks, fillNewElements);
}

// --- The motion as tables

std::shared_ptr<MultiValueSeq> BodyMotion::jointPosSeq() {
  if (!extraSeq<MultiValueSeq>(jointDisplacementContentName())) updateJointPosSeqWithBodyStateSeq();
  return extraSeq<MultiValueSeq>(jointDisplacementContentName());
}

std::shared_ptr<const MultiValueSeq> BodyMotion::jointPosSeq() const {
  return const_cast<BodyMotion*>(this)->jointPosSeq();
}

std::shared_ptr<MultiSE3Seq> BodyMotion::linkPosSeq() {
  if (!extraSeq<MultiSE3Seq>(linkPositionContentName())) updateLinkPosSeqWithBodyStateSeq();
  return extraSeq<MultiSE3Seq>(linkPositionContentName());
}

std::shared_ptr<const MultiSE3Seq> BodyMotion::linkPosSeq() const {
  return const_cast<BodyMotion*>(this)->linkPosSeq();
}

void BodyMotion::updateJointPosSeqWithBodyStateSeq() {
  const auto table = getOrCreateExtraSeq<MultiValueSeq>(jointDisplacementContentName());
  table->setDimension(0, numJoints());
  table->setNumFrames(numFrames());
  for (int i = 0; i < numFrames(); ++i) {
    const BodyState& state = stateSeq_->frame(i);
    const int n = std::min(numJoints(), state.numJointDisplacements());
    for (int j = 0; j < n; ++j) table->frame(i)[j] = state.jointDisplacement(j);
  }
}

void BodyMotion::updateLinkPosSeqWithBodyStateSeq() {
  const auto table = getOrCreateExtraSeq<MultiSE3Seq>(linkPositionContentName());
  table->setDimension(0, numLinks());
  table->setNumFrames(numFrames());
  for (int i = 0; i < numFrames(); ++i) {
    const BodyState& state = stateSeq_->frame(i);
    const int n = std::min(numLinks(), state.numLinkPositions());
    for (int j = 0; j < n; ++j) state.linkPosition(j).get(table->frame(i)[j]);
  }
}

void BodyMotion::updateLinkPosSeqAndJointPosSeqWithBodyStateSeq() {
  updateLinkPosSeqWithBodyStateSeq();
  updateJointPosSeqWithBodyStateSeq();
}

void BodyMotion::updateBodyStateSeqWithLinkPosSeqAndJointPosSeq() {
  const auto links = extraSeq<MultiSE3Seq>(linkPositionContentName());
  const auto joints = extraSeq<MultiValueSeq>(jointDisplacementContentName());
  const AbstractSeq* either = links ? static_cast<AbstractSeq*>(links.get()) : joints.get();
  if (!either) return;
  if (links && joints && links->numFrames() != joints->numFrames()) {
    throw std::logic_error("a motion has " + std::to_string(links->numFrames()) + " frames of link positions and " +
                           std::to_string(joints->numFrames()) + " of joint displacements");
  }
  stateSeq_->setNumLinkPositionsHint(links ? links->numParts() : 0);
  stateSeq_->setNumJointDisplacementsHint(joints ? joints->numParts() : 0);
  stateSeq_->setNumFrames(either->getNumFrames());
  stateSeq_->setFrameRate(either->getFrameRate());
  stateSeq_->setOffsetTime(either->getOffsetTime());
  for (int i = 0; i < numFrames(); ++i) {
    BodyState& state = stateSeq_->allocateFrame(i);
    for (int j = 0; j < numLinks(); ++j) state.linkPosition(j).set(links->frame(i)[j]);
    for (int j = 0; j < numJoints(); ++j) state.jointDisplacement(j) = joints->frame(i)[j];
  }
}

// --- Additional sequences

void BodyMotion::setExtraSeq(std::shared_ptr<AbstractSeq> seq) {
  if (seq->seqContentName().empty()) return;
  extraSeqs_[seq->seqContentName()] = std::move(seq);
  sigExtraSeqsChanged_();
}

void BodyMotion::clearExtraSeqs() {
  if (extraSeqs_.empty()) return;
  extraSeqs_.clear();
  sigExtraSeqsChanged_();
}

void BodyMotion::clearExtraSeq(const std::string& contentName) {
  if (extraSeqs_.erase(contentName) > 0) sigExtraSeqsChanged_();
}

// --- Frames to and from a body

BodyMotion::Frame operator<<(BodyMotion::Frame frame, const Body& body) {
  BodyStateSeq& states = *frame.motion().stateSeq();
  if (frame.frame() >= states.numFrames()) states.setNumFrames(frame.frame() + 1);
  states.frame(frame.frame()) << body;
  return frame;
}

BodyMotion::Frame operator>>(BodyMotion::Frame frame, Body& body) {
  frame.motion().stateSeq()->frame(frame.frame()) >> body;
  return frame;
}

BodyMotion::ConstFrame operator>>(BodyMotion::ConstFrame frame, Body& body) {
  frame.motion().stateSeq()->frame(frame.frame()) >> body;
  return frame;
}

Body& operator<<(Body& body, BodyMotion::Frame frame) {
  frame >> body;
  return body;
}

Body& operator<<(Body& body, BodyMotion::ConstFrame frame) {
  frame >> body;
  return body;
}

const Body& operator>>(const Body& body, BodyMotion::Frame frame) {
  frame << body;
  return body;
}

// --- ZMPSeq

namespace {
const char* const zmpContentName = "ZMP";
}

ZMPSeq::ZMPSeq(int numFrames) : Vector3Seq(numFrames) { setSeqContentName(zmpContentName); }

ZMPSeq::~ZMPSeq() = default;

std::shared_ptr<AbstractSeq> ZMPSeq::cloneSeq() const { return std::make_shared<ZMPSeq>(*this); }

bool ZMPSeq::doReadSeq(const Mapping* archive, std::ostream& os) {
  if (!Vector3Seq::doReadSeq(archive, os)) return false;
  archive->read({"is_root_relative", "isRootRelative"}, isRootRelative_);
  return true;
}

std::shared_ptr<ZMPSeq> getZMPSeq(const BodyMotion& motion) { return motion.extraSeq<ZMPSeq>(zmpContentName); }

std::shared_ptr<ZMPSeq> getOrCreateZMPSeq(BodyMotion& motion) {
  return motion.getOrCreateExtraSeq<ZMPSeq>(zmpContentName);
}

void clearZMPSeq(BodyMotion& motion) { motion.clearExtraSeq(zmpContentName); }

}  // namespace cnoid
