// Vector3Seq: one vector per frame.
#pragma once

#include "EigenTypes.h"
#include "Seq.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT Vector3Seq : public Seq<Vector3> {
 public:
  /// All vectors are zero.
  explicit Vector3Seq(int numFrames = 0);
  Vector3Seq(const Vector3Seq&) = default;
  Vector3Seq& operator=(const Vector3Seq&) = default;
  ~Vector3Seq() override;

  std::shared_ptr<AbstractSeq> cloneSeq() const override;

 protected:
  Vector3 defaultValue() const override { return Vector3::Zero(); }
  bool doReadSeq(const Mapping* archive, std::ostream& os) override;
};

using Vector3SeqPtr = std::shared_ptr<Vector3Seq>;

}  // namespace cnoid
