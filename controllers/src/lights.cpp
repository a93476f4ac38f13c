#include <cnoid/Light>
#include <cnoid/PointLight>
#include <cnoid/SpotLight>

#include "device_state_cast.h"

namespace cnoid {

namespace {
constexpr int lightStateSize = 5;
constexpr int pointLightStateSize = 3;
constexpr int spotLightStateSize = 6;
}  // namespace

Light::Light() : color_(Vector3f::Ones()) {}

bool Light::on() const { return on_; }

void Light::on(bool on) { on_ = on; }

void Light::copyLightStateFrom(const Light& other) {
  on_ = other.on_;
  color_ = other.color_;
  intensity_ = other.intensity_;
}

int Light::stateSize() const { return lightStateSize; }

double* Light::writeState(double* buffer) const {
  buffer[0] = on_ ? 1.0 : 0.0;
  for (int i = 0; i < 3; ++i) buffer[1 + i] = color_[i];
  buffer[4] = intensity_;
  return buffer + lightStateSize;
}

const double* Light::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  on_ = buffer[0] != 0.0;
  color_ = Eigen::Map<const Vector3>(buffer + 1).cast<float>();
  intensity_ = static_cast<float>(buffer[4]);
  return buffer + lightStateSize;
}

PointLight::PointLight() = default;

const char* PointLight::typeName() const { return "PointLight"; }

void PointLight::copyStateFrom(const DeviceState& other) { copyPointLightStateFrom(sameType<PointLight>(other)); }

void PointLight::copyPointLightStateFrom(const PointLight& other) {
  copyLightStateFrom(other);
  constantAttenuation_ = other.constantAttenuation_;
  linearAttenuation_ = other.linearAttenuation_;
  quadraticAttenuation_ = other.quadraticAttenuation_;
}

Referenced* PointLight::doClone(CloneMap*) const { return new PointLight(*this); }

int PointLight::stateSize() const { return Light::stateSize() + pointLightStateSize; }

double* PointLight::writeState(double* buffer) const {
  buffer = Light::writeState(buffer);
  buffer[0] = constantAttenuation_;
  buffer[1] = linearAttenuation_;
  buffer[2] = quadraticAttenuation_;
  return buffer + pointLightStateSize;
}

const double* PointLight::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  buffer = Light::readState(buffer, size);
  constantAttenuation_ = static_cast<float>(buffer[0]);
  linearAttenuation_ = static_cast<float>(buffer[1]);
  quadraticAttenuation_ = static_cast<float>(buffer[2]);
  return buffer + pointLightStateSize;
}

SpotLight::SpotLight() : direction_(-Vector3::UnitZ()) {}

const char* SpotLight::typeName() const { return "SpotLight"; }

void SpotLight::copyStateFrom(const DeviceState& other) {
  const auto& light = sameType<SpotLight>(other);
  copyPointLightStateFrom(light);
  direction_ = light.direction_;
  beamWidth_ = light.beamWidth_;
  cutOffAngle_ = light.cutOffAngle_;
  cutOffExponent_ = light.cutOffExponent_;
}

Referenced* SpotLight::doClone(CloneMap*) const { return new SpotLight(*this); }

int SpotLight::stateSize() const { return PointLight::stateSize() + spotLightStateSize; }

double* SpotLight::writeState(double* buffer) const {
  buffer = PointLight::writeState(buffer);
  for (int i = 0; i < 3; ++i) buffer[i] = direction_[i];
  buffer[3] = beamWidth_;
  buffer[4] = cutOffAngle_;
  buffer[5] = cutOffExponent_;
  return buffer + spotLightStateSize;
}

const double* SpotLight::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  buffer = PointLight::readState(buffer, size);
  direction_ = Eigen::Map<const Vector3>(buffer);
  beamWidth_ = static_cast<float>(buffer[3]);
  cutOffAngle_ = static_cast<float>(buffer[4]);
  cutOffExponent_ = static_cast<float>(buffer[5]);
  return buffer + spotLightStateSize;
}

}  // namespace cnoid
