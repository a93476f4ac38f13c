// Imu: a gyro and an accelerometer in one. See RateGyroSensor and AccelerationSensor for their measurements.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT Imu : public Device {
 public:
  Imu();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // w, then dv
  const double* readState(const double* buffer, int size) override;

  /// Angular velocity, sensor frame [rad/s].
  Vector3& w() { return w_; }
  const Vector3& w() const { return w_; }

  /// Specific force, sensor frame [m/s²].
  Vector3& dv() { return dv_; }
  const Vector3& dv() const { return dv_; }

  /// Range of the sensor. Stored only: readings are not clipped.
  Vector3& w_max() { return w_max_; }
  const Vector3& w_max() const { return w_max_; }
  Vector3& dv_max() { return dv_max_; }
  const Vector3& dv_max() const { return dv_max_; }

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  Vector3 w_;
  Vector3 dv_;
  Vector3 w_max_;
  Vector3 dv_max_;
};

using ImuPtr = ref_ptr<Imu>;

}  // namespace cnoid
