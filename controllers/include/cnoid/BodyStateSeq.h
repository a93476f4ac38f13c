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

  /// The default numbers of links, joints and devices per frame; single frames may have different numbers.
  int numLinkPositionsHint() const { return numLinks_; }
  void setNumLinkPositionsHint(int n) { numLinks_ = n; }
  int numJointDisplacementsHint() const { return numJoints_; }
  void setNumJointDisplacementsHint(int n) { numJoints_ = n; }
  int numDeviceStatesHint() const { return numDevices_; }
  void setNumDeviceStatesHint(int n) { numDevices_ = n; }

  /// Allocates frame `index` with these numbers of links, joints and devices; the sequence grows as needed.
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
