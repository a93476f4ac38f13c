// ZMPSeq: the planned zero moment point of a walking robot, as part of its motion.
#pragma once

#include "BodyMotion.h"
#include "Vector3Seq.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT ZMPSeq : public Vector3Seq {
 public:
  explicit ZMPSeq(int numFrames = 0);
  ZMPSeq(const ZMPSeq&) = default;
  ZMPSeq& operator=(const ZMPSeq&) = default;
  ~ZMPSeq() override;

  std::shared_ptr<AbstractSeq> cloneSeq() const override;

  /// True if the ZMP is in the root link's frame; false for the world's frame.
  bool isRootRelative() const { return isRootRelative_; }
  void setRootRelative(bool on) { isRootRelative_ = on; }

 protected:
  bool doReadSeq(const Mapping* archive, std::ostream& os) override;

 private:
  bool isRootRelative_ = false;
};

/// Null if the motion has no ZMP.
CNOID_GENERAL_EXPORT std::shared_ptr<ZMPSeq> getZMPSeq(const BodyMotion& motion);
CNOID_GENERAL_EXPORT std::shared_ptr<ZMPSeq> getOrCreateZMPSeq(BodyMotion& motion);
CNOID_GENERAL_EXPORT void clearZMPSeq(BodyMotion& motion);

}  // namespace cnoid
