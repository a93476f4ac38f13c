// BodyStateSeq: the states of a body over time.
#pragma once

#include "BodyState.h"
#include "Seq.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT BodyStateSeq : public Seq<BodyState> {
 public:
  explicit BodyStateSeq(int numFrames = 0);
  BodyStateSeq(const BodyStateSeq&) = default;
  BodyStateSeq& operator=(const BodyStateSeq&) = default;
  ~BodyStateSeq() override;

  std::shared_ptr<AbstractSeq> cloneSeq() const override;

  /// How many of each a frame is meant to have; frames may have others.
  int numLinkPositionsHint() const { return numLinks_; }
  void setNumLinkPositionsHint(int n) { numLinks_ = n; }
  int numJointDisplacementsHint() const { return numJoints_; }
  void setNumJointDisplacementsHint(int n) { numJoints_ = n; }
  int numDeviceStatesHint() const { return numDevices_; }
  void setNumDeviceStatesHint(int n) { numDevices_ = n; }

  /// A frame of that many; the sequence grows as needed.
  BodyState& allocateFrame(int index) { return allocateFrame(index, numLinks_, numJoints_, numDevices_); }
  BodyState& allocateFrame(int index, int numLinks, int numJoints, int numDevices) {
    if (index >= numFrames()) setNumFrames(index + 1);
    return frame(index).allocate(numLinks, numJoints, numDevices);
  }
  BodyState& appendAllocatedFrame() { return allocateFrame(numFrames()); }

 private:
  int numLinks_ = 0;
  int numJoints_ = 0;
  int numDevices_ = 0;
};

using BodyPositionSeq [[deprecated("Use BodyStateSeq.")]] = BodyStateSeq;

}  // namespace cnoid
