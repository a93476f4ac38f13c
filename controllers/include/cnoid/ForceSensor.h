// ForceSensor: the force and torque that pass through a link's joint.
//
// The wrench is the one that the sensor's link exerts on its parent, in the sensor frame, torque about the sensor's
// origin. A foot sensor of a standing robot reads about the weight above it along +z.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT ForceSensor : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  ForceSensor();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  /// Force [N], then torque [N·m].
  Vector6& F() { return F_; }
  const Vector6& F() const { return F_; }
  Vector6& wrench() { return F_; }
  const Vector6& wrench() const { return F_; }

  Vector6::FixedSegmentReturnType<3>::Type f() { return F_.head<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type f() const { return F_.head<3>(); }
  Vector6::FixedSegmentReturnType<3>::Type force() { return F_.head<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type force() const { return F_.head<3>(); }

  Vector6::FixedSegmentReturnType<3>::Type tau() { return F_.tail<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type tau() const { return F_.tail<3>(); }
  Vector6::FixedSegmentReturnType<3>::Type torque() { return F_.tail<3>(); }
  Vector6::ConstFixedSegmentReturnType<3>::Type torque() const { return F_.tail<3>(); }

  /// Range of the sensor. Stored only: readings are not clipped.
  Vector6& F_max() { return F_max_; }
  const Vector6& F_max() const { return F_max_; }
  Vector6& maxWrench() { return F_max_; }
  const Vector6& maxWrench() const { return F_max_; }

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  Vector6 F_;
  Vector6 F_max_;
};

using ForceSensorPtr = ref_ptr<ForceSensor>;

}  // namespace cnoid
