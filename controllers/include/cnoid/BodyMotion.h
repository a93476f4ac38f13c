// BodyMotion: a motion of a body, as stored in .seq files: joint displacements, poses of links, and additional
// sequences.
//
//   cnoid::BodyMotion motion;
//   if (!motion.load(filename)) { io->os() << motion.seqMessage(); return false; }
//   auto q = motion.jointPosSeq();            // numFrames() x numParts() numbers [rad, m]
//   joint->q_target() = q->clampedFrame(tick)[joint->jointId()];
//
// stateSeq() contains the motion. jointPosSeq() and linkPosSeq() are tables that are made from it at the first call;
// after changing a table or stateSeq(), call the update function of that direction.
#pragma once

#include "BodyStateSeq.h"
#include "MultiSE3Seq.h"
#include "MultiValueSeq.h"
#include "Signal.h"

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace cnoid {

class Body;

class CNOID_GENERAL_EXPORT BodyMotion : public AbstractSeq {
 public:
  BodyMotion();
  /// Deep copies.
  BodyMotion(const BodyMotion& other);
  BodyMotion& operator=(const BodyMotion& other);
  ~BodyMotion() override;

  std::shared_ptr<AbstractSeq> cloneSeq() const override;

  /// Reads a .seq file: YAML, type CompositeSeq, content BodyMotion, format version 1 to 4. On failure returns false
  /// and leaves no frames; `os` and seqMessage() then state the reason, with file, line and column.
  bool load(const std::string& filename, std::ostream& os = nullout());

  double frameRate() const { return stateSeq_->frameRate(); }
  double timeStep() const { return stateSeq_->timeStep(); }
  double offsetTime() const { return stateSeq_->offsetTime(); }
  int numFrames() const { return stateSeq_->numFrames(); }
  int numLinks() const { return stateSeq_->numLinkPositionsHint(); }
  int numJoints() const { return stateSeq_->numJointDisplacementsHint(); }

  double getFrameRate() const override { return frameRate(); }
  void setFrameRate(double rate) override;
  double getOffsetTime() const override { return offsetTime(); }
  void setOffsetTime(double time) override;
  int getNumFrames() const override { return numFrames(); }
  void setNumFrames(int n, bool fillNewElements = false) override;
  void setNumJoints(int numJoints, bool fillNewElements = false);
  void setDimension(int numFrames, int numJoints, int numLinks, bool fillNewElements = false);

  std::shared_ptr<BodyStateSeq> stateSeq() { return stateSeq_; }
  std::shared_ptr<const BodyStateSeq> stateSeq() const { return stateSeq_; }
  std::shared_ptr<MultiValueSeq> jointPosSeq();
  std::shared_ptr<const MultiValueSeq> jointPosSeq() const;
  std::shared_ptr<MultiSE3Seq> linkPosSeq();
  std::shared_ptr<const MultiSE3Seq> linkPosSeq() const;

  void updateJointPosSeqWithBodyStateSeq();
  void updateLinkPosSeqWithBodyStateSeq();
  void updateLinkPosSeqAndJointPosSeqWithBodyStateSeq();
  /// Throws std::logic_error if both tables exist with different numbers of frames. No effect if neither exists.
  void updateBodyStateSeqWithLinkPosSeqAndJointPosSeq();
  [[deprecated("Use stateSeq.")]] std::shared_ptr<BodyStateSeq> positionSeq() { return stateSeq_; }
  [[deprecated("Use updateJointPosSeqWithBodyStateSeq.")]] void updateJointPosSeqWithBodyPositionSeq() {
    updateJointPosSeqWithBodyStateSeq();
  }
  [[deprecated("Use updateLinkPosSeqWithBodyStateSeq.")]] void updateLinkPosSeqWithBodyPositionSeq() {
    updateLinkPosSeqWithBodyStateSeq();
  }
  [[deprecated("Use numJoints.")]] int getNumParts() const { return numJoints(); }
  [[deprecated("Use load.")]] bool loadStandardYAMLformat(const std::string& filename, std::ostream& os = nullout()) {
    return load(filename, os);
  }

  static const std::string& linkPositionContentName();
  static const std::string& jointDisplacementContentName();
  static const std::string& jointEffortContentName();

  // --- Frames to and from a body: `motion.frame(i) >> *body`, `motion.frame(i) << *body`

  template <class Motion>
  class FrameOf {
   public:
    FrameOf(Motion& motion, int frame) : motion_(motion), frame_(frame) {}
    Motion& motion() const { return motion_; }
    int frame() const { return frame_; }

   private:
    Motion& motion_;
    int frame_;
  };
  using Frame = FrameOf<BodyMotion>;
  using ConstFrame = FrameOf<const BodyMotion>;
  Frame frame(int index) { return Frame(*this, index); }
  ConstFrame frame(int index) const { return ConstFrame(*this, index); }

  // --- Additional sequences, by their content name, in alphabetical order

  using ExtraSeqMap = std::map<std::string, std::shared_ptr<AbstractSeq>>;
  using ConstSeqIterator = ExtraSeqMap::const_iterator;
  bool hasExtraSeqs() const { return !extraSeqs_.empty(); }
  ConstSeqIterator extraSeqBegin() const { return extraSeqs_.begin(); }
  ConstSeqIterator extraSeqEnd() const { return extraSeqs_.end(); }
  /// Null if there is no sequence of that name and type.
  template <class SeqType>
  std::shared_ptr<SeqType> extraSeq(const std::string& contentName) const {
    const auto entry = extraSeqs_.find(contentName);
    return entry == extraSeqs_.end() ? nullptr : std::dynamic_pointer_cast<SeqType>(entry->second);
  }
  template <class SeqType>
  std::shared_ptr<SeqType> getOrCreateExtraSeq(const std::string& contentName,
                                               std::function<void(SeqType& seq)> initialize = nullptr) {
    if (auto existing = extraSeq<SeqType>(contentName)) return existing;
    auto seq = std::make_shared<SeqType>();
    seq->setSeqContentName(contentName);
    seq->setFrameRate(frameRate());
    seq->setNumFrames(numFrames());
    seq->setOffsetTime(offsetTime());
    if (initialize) initialize(*seq);
    setExtraSeq(seq);
    return seq;
  }
  /// Stores the sequence under its content name; a sequence without one is not stored.
  void setExtraSeq(std::shared_ptr<AbstractSeq> seq);
  void clearExtraSeqs();
  void clearExtraSeq(const std::string& contentName);
  SignalProxy<void()> sigExtraSeqsChanged() { return sigExtraSeqsChanged_; }

 protected:
  bool doReadSeq(const Mapping* archive, std::ostream& os) override;

 private:
  void readComponent(const Mapping& component, double version, std::ostream& os);
  void copyExtraSeqs(const BodyMotion& other);

  std::shared_ptr<BodyStateSeq> stateSeq_;
  ExtraSeqMap extraSeqs_;
  Signal<void()> sigExtraSeqsChanged_;
};

CNOID_GENERAL_EXPORT BodyMotion::Frame operator<<(BodyMotion::Frame frame, const Body& body);
CNOID_GENERAL_EXPORT BodyMotion::Frame operator>>(BodyMotion::Frame frame, Body& body);
CNOID_GENERAL_EXPORT BodyMotion::ConstFrame operator>>(BodyMotion::ConstFrame frame, Body& body);
CNOID_GENERAL_EXPORT Body& operator<<(Body& body, BodyMotion::Frame frame);
CNOID_GENERAL_EXPORT Body& operator<<(Body& body, BodyMotion::ConstFrame frame);
CNOID_GENERAL_EXPORT const Body& operator>>(const Body& body, BodyMotion::Frame frame);

}  // namespace cnoid
