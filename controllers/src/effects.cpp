// Devices with particles, and the sliders of a window that isn't there.
#include <cnoid/FireDevice>
#include <cnoid/FountainDevice>
#include <cnoid/GeneralSliderView>

#include "device_state_cast.h"

namespace cnoid {

double* ParticleSystem::writeState(double* buffer) const {
  *buffer++ = on_ ? 1.0 : 0.0;
  *buffer++ = offsetTime_;
  *buffer++ = lifeTime_;
  *buffer++ = particleSize_;
  *buffer++ = numParticles_;
  *buffer++ = initialSpeedAverage_;
  *buffer++ = initialSpeedVariation_;
  *buffer++ = emissionRange_;
  for (int i = 0; i < 3; ++i) *buffer++ = acceleration_[i];
  for (int i = 0; i < 3; ++i) *buffer++ = tintColor_[i];
  return buffer;
}

const double* ParticleSystem::readState(const double* buffer) {
  on_ = *buffer++ != 0.0;
  offsetTime_ = static_cast<float>(*buffer++);
  lifeTime_ = static_cast<float>(*buffer++);
  particleSize_ = static_cast<float>(*buffer++);
  numParticles_ = static_cast<int>(*buffer++);
  initialSpeedAverage_ = static_cast<float>(*buffer++);
  initialSpeedVariation_ = static_cast<float>(*buffer++);
  emissionRange_ = static_cast<float>(*buffer++);
  for (int i = 0; i < 3; ++i) acceleration_[i] = static_cast<float>(*buffer++);
  for (int i = 0; i < 3; ++i) tintColor_[i] = static_cast<float>(*buffer++);
  return buffer;
}

FireDevice::FireDevice() {
  particleSystem_.setLifeTime(5.0f);
  particleSystem_.setAcceleration(Vector3f(0.0f, 0.0f, 0.05f));
  particleSystem_.setNumParticles(200);
  particleSystem_.setParticleSize(0.25f);
  particleSystem_.setEmissionRange(1.5707963f);
}

const char* FireDevice::typeName() const { return "FireDevice"; }
Referenced* FireDevice::doClone(CloneMap*) const { return new FireDevice(*this); }
int FireDevice::stateSize() const { return ParticleSystem::stateSize; }
double* FireDevice::writeState(double* buffer) const { return particleSystem_.writeState(buffer); }
void FireDevice::copyStateFrom(const DeviceState& other) {
  particleSystem_ = sameType<FireDevice>(other).particleSystem_;
}
const double* FireDevice::readState(const double* buffer, int size) {
  return size < stateSize() ? buffer : particleSystem_.readState(buffer);
}

FountainDevice::FountainDevice() {
  particleSystem_.setParticleSize(0.05f);
  particleSystem_.setNumParticles(1000);
  particleSystem_.setAcceleration(Vector3f(0.0f, 0.0f, -0.2f));
  particleSystem_.setEmissionRange(0.5235988f);
}

const char* FountainDevice::typeName() const { return "FountainDevice"; }
Referenced* FountainDevice::doClone(CloneMap*) const { return new FountainDevice(*this); }
int FountainDevice::stateSize() const { return ParticleSystem::stateSize; }
double* FountainDevice::writeState(double* buffer) const { return particleSystem_.writeState(buffer); }
void FountainDevice::copyStateFrom(const DeviceState& other) {
  particleSystem_ = sameType<FountainDevice>(other).particleSystem_;
}
const double* FountainDevice::readState(const double* buffer, int size) {
  return size < stateSize() ? buffer : particleSystem_.readState(buffer);
}

GeneralSliderView* GeneralSliderView::instance() {
  static GeneralSliderView only;
  return &only;
}

GeneralSliderView::SliderPtr GeneralSliderView::getOrCreateSlider(const std::string& name, double, double, int) {
  return new Slider(name);
}

}  // namespace cnoid
