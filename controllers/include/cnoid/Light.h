// Light: base class of all lights. Its values are float, as in Choreonoid, because controller sources rely on it.
#pragma once

#include "Device.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT Light : public Device {
 public:
  bool on() const override;
  void on(bool on) override;

  /// Red, green, blue, 0 to 1.
  const Vector3f& color() const { return color_; }
  void setColor(const Vector3f& color) { color_ = color; }
  void setColor(const Vector3& color) { color_ = color.cast<float>(); }

  float intensity() const { return intensity_; }
  void setIntensity(float intensity) { intensity_ = intensity; }

  int stateSize() const override;
  double* writeState(double* buffer) const override;  // on (0 or 1), colour, intensity
  const double* readState(const double* buffer, int size) override;

 protected:
  Light();
  Light(const Light& other) = default;
  void copyLightStateFrom(const Light& other);

 private:
  Vector3f color_;
  float intensity_ = 1.0f;
  bool on_ = true;
};

using LightPtr = ref_ptr<Light>;

}  // namespace cnoid
