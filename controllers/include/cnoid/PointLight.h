// PointLight: a light that shines in all directions from its frame's origin.
//
// At a distance d its light is divided by constant + linear * d + quadratic * d².
#pragma once

#include "Light.h"

namespace cnoid {

class CNOID_GENERAL_EXPORT PointLight : public Light {
 public:
  PointLight();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // Light's; constant, linear, quadratic attenuation
  const double* readState(const double* buffer, int size) override;

  float constantAttenuation() const { return constantAttenuation_; }
  void setConstantAttenuation(float attenuation) { constantAttenuation_ = attenuation; }
  float linearAttenuation() const { return linearAttenuation_; }  // [1/m]
  void setLinearAttenuation(float attenuation) { linearAttenuation_ = attenuation; }
  float quadraticAttenuation() const { return quadraticAttenuation_; }  // [1/m²]
  void setQuadraticAttenuation(float attenuation) { quadraticAttenuation_ = attenuation; }

 protected:
  PointLight(const PointLight& other) = default;
  void copyPointLightStateFrom(const PointLight& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  float constantAttenuation_ = 1.0f;
  float linearAttenuation_ = 0.0f;
  float quadraticAttenuation_ = 0.0f;
};

using PointLightPtr = ref_ptr<PointLight>;

}  // namespace cnoid
