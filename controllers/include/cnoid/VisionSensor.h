// VisionSensor: base class of cameras and range sensors.
//
// It captures at its frame rate, in simulated time, and delivers one cycle later. The optical frame is the device frame
// turned by opticalFrameRotation(): by default it looks along -z with +y up.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT VisionSensor : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  bool on() const override;
  void on(bool on) override;

  /// Captures per second of simulated time [Hz].
  double frameRate() const { return frameRate_; }
  void setFrameRate(double hertz) { frameRate_ = hertz; }

  /// Time from the capture of the data to its delivery [s].
  double delay() const { return delay_; }
  void setDelay(double seconds) { delay_ = seconds; }

  /// Rotation from the device frame to the optical frame.
  const Matrix3& opticalFrameRotation() const { return R_optical_; }
  template <typename Derived>
  void setOpticalFrameRotation(const Eigen::MatrixBase<Derived>& rotation) {
    R_optical_ = rotation.template cast<double>();
  }

  /// GL looks along -z with +y up, CV along +z with -y up, Robotics along +x with +z up.
  enum OpticalFrameType { GL, CV, Robotics };
  /// Throws std::invalid_argument for a different number.
  static Matrix3 opticalFrameRotationOfType(int opticalFrameType);
  void setOpticalFrame(int opticalFrameType) { R_optical_ = opticalFrameRotationOfType(opticalFrameType); }

  int stateSize() const override;
  double* writeState(double* buffer) const override;  // on (0 or 1), frame rate, delay
  const double* readState(const double* buffer, int size) override;

 protected:
  VisionSensor();
  VisionSensor(const VisionSensor& other) = default;
  void copyVisionSensorStateFrom(const VisionSensor& other);

 private:
  bool on_ = true;
  double frameRate_ = 30.0;
  double delay_ = 0.0;
  Matrix3 R_optical_;
};

using VisionSensorPtr = ref_ptr<VisionSensor>;

}  // namespace cnoid
