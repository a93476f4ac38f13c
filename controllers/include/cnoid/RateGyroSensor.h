// RateGyroSensor: angular velocity of its link, in the sensor frame.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT RateGyroSensor : public Device {
 public:
  RateGyroSensor();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  /// [rad/s]
  Vector3& w() { return w_; }
  const Vector3& w() const { return w_; }

  /// Range of the sensor [rad/s]. Stored only: readings are not clipped.
  Vector3& w_max() { return w_max_; }
  const Vector3& w_max() const { return w_max_; }

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  Vector3 w_;
  Vector3 w_max_;
};

using RateGyroSensorPtr = ref_ptr<RateGyroSensor>;

}  // namespace cnoid
