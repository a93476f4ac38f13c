// SpotLight: a light that shines in a cone.
#pragma once

#include "PointLight.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT SpotLight : public PointLight {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  SpotLight();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // PointLight's; direction, beam width, cut-off angle, exponent
  const double* readState(const double* buffer, int size) override;

  /// The direction in the device frame; -z by default.
  const Vector3& direction() const { return direction_; }
  void setDirection(const Vector3& direction) { direction_ = direction; }

  /// The light has its full strength up to this angle [rad].
  float beamWidth() const { return beamWidth_; }
  void setBeamWidth(float angle) { beamWidth_ = angle; }
  /// No light beyond this angle [rad].
  float cutOffAngle() const { return cutOffAngle_; }
  void setCutOffAngle(float angle) { cutOffAngle_ = angle; }
  /// The exponent of the decrease between the two angles.
  float cutOffExponent() const { return cutOffExponent_; }
  void setCutOffExponent(float exponent) { cutOffExponent_ = exponent; }

 protected:
  SpotLight(const SpotLight& other) = default;
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  Vector3 direction_;
  float beamWidth_ = 1.570796f;
  float cutOffAngle_ = 0.785398f;
  float cutOffExponent_ = 1.0f;
};

using SpotLightPtr = ref_ptr<SpotLight>;

}  // namespace cnoid
