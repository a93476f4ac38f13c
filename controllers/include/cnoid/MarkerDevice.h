// MarkerDevice: a sign that a picture shows at the device's place, for people.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT MarkerDevice : public Device {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  MarkerDevice();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  int stateSize() const override;
  /// on; type; size; colour r, g, b; emission; transparency; offset x, y, z; rotation as a quaternion w, x, y, z.
  double* writeState(double* buffer) const override;
  const double* readState(const double* buffer, int size) override;

  bool on() const override;
  void on(bool on) override;

  enum MarkerType { CROSS_MARKER, SPHERE_MARKER, AXES_MARKER, N_MARKER_TYPES };
  int markerType() const { return markerType_; }
  void setMarkerType(int type) { markerType_ = type; }
  double markerSize() const { return markerSize_; }  // [m]
  void setMarkerSize(double size) { markerSize_ = size; }

  const Vector3f& color() const { return color_; }  // 0 to 1
  void setColor(const Vector3f& color) { color_ = color; }
  float emission() const { return emission_; }
  void setEmission(float emission) { emission_ = emission; }
  float transparency() const { return transparency_; }
  void setTransparency(float transparency) { transparency_ = transparency; }

  /// The pose of the sign in the device frame.
  const Isometry3& offsetPosition() const { return offsetPosition_; }
  void setOffsetPosition(const Isometry3& T) { offsetPosition_ = T; }
  void setOffsetTranslation(const Vector3& p) { offsetPosition_.translation() = p; }

 protected:
  MarkerDevice(const MarkerDevice& other) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  bool on_ = true;
  int markerType_ = SPHERE_MARKER;
  double markerSize_ = 0.01;
  Vector3f color_;
  float emission_ = 0.5f;
  float transparency_ = 0.7f;
  Isometry3 offsetPosition_;
};

using MarkerDevicePtr = ref_ptr<MarkerDevice>;

}  // namespace cnoid
