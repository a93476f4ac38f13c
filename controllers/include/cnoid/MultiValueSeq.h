// MultiValueSeq: several numbers per frame, for example one joint displacement [rad, m] for each joint.
#pragma once

#include "MultiSeq.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT MultiValueSeq : public MultiSeq<double> {
 public:
  MultiValueSeq();
  /// All values are zero.
  explicit MultiValueSeq(int numFrames, int numParts = 1);
  MultiValueSeq(const MultiValueSeq&) = default;
  MultiValueSeq& operator=(const MultiValueSeq&) = default;
  ~MultiValueSeq() override;

  std::shared_ptr<AbstractSeq> cloneSeq() const override;

 protected:
  bool doReadSeq(const Mapping* archive, std::ostream& os) override;
};

using MultiValueSeqPtr = std::shared_ptr<MultiValueSeq>;

}  // namespace cnoid
