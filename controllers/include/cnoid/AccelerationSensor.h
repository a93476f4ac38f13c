// AccelerationSensor: specific force, in the sensor frame.
//
// The reading of a real accelerometer: acceleration minus gravity. At rest and level z reads +9.80665 m/s², in free
// fall 0. The acceleration is that of the link's origin.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT AccelerationSensor : public Device {
 public:
  AccelerationSensor();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  /// [m/s²]
  Vector3& dv() { return dv_; }
  const Vector3& dv() const { return dv_; }

  /// Range of the sensor [m/s²]. Stored only: readings are not clipped.
  Vector3& dv_max() { return dv_max_; }
  const Vector3& dv_max() const { return dv_max_; }

 protected:
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  Vector3 dv_;
  Vector3 dv_max_;
};

using AccelerationSensorPtr = ref_ptr<AccelerationSensor>;

}  // namespace cnoid
