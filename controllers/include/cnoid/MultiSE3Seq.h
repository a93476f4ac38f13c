// MultiSE3Seq: several poses per frame, for example one for each link.
#pragma once

#include "EigenTypes.h"
#include "MultiSeq.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT MultiSE3Seq : public MultiSeq<SE3> {
 public:
  MultiSE3Seq();
  /// All poses are at the origin.
  explicit MultiSE3Seq(int numFrames, int numParts = 1);
  MultiSE3Seq(const MultiSE3Seq&) = default;
  MultiSE3Seq& operator=(const MultiSE3Seq&) = default;
  ~MultiSE3Seq() override;

  std::shared_ptr<AbstractSeq> cloneSeq() const override;

 protected:
  SE3 defaultValue() const override;
  /// SE3Format: XYZQWQXQYQZ, XYZRPY; in format version 1 also: format: XYZQXQYQZQW.
  bool doReadSeq(const Mapping* archive, std::ostream& os) override;
};

using MultiSE3SeqPtr = std::shared_ptr<MultiSE3Seq>;

}  // namespace cnoid
