// ZmpDevice: a place to store a zero-moment point with a body. No model has one, and nothing measures it.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT ZmpDevice : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  ZmpDevice();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // on; x, y, z
  const double* readState(const double* buffer, int size) override;

  /// On by default.
  bool on() const override { return on_; }
  void on(bool on) override { on_ = on; }

  const Vector3& zmp() const { return zmp_; }  // in the world [m]
  void setZmp(const Vector3& zmp) { zmp_ = zmp; }

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  Vector3 zmp_;
  bool on_ = true;
};

using ZmpDevicePtr = ref_ptr<ZmpDevice>;

}  // namespace cnoid
