#include <cnoid/RotorDevice>

#include "device_state_cast.h"

namespace Multicopter {

namespace {
constexpr int rotorStateSize = 19;
}

RotorDevice::RotorDevice() : position_(cnoid::Vector3::Zero()), direction_(cnoid::Vector3::UnitZ()) {}

cnoid::Referenced* RotorDevice::doClone(cnoid::CloneMap*) const { return new RotorDevice(*this); }

const char* RotorDevice::typeName() const { return "RotorDevice"; }

void RotorDevice::setPosition(const cnoid::Vector3& position) {
  position_ = position;
  setLocalTranslation(position);
}

void RotorDevice::copyStateFrom(const cnoid::DeviceState& other) {
  const auto& rotor = cnoid::sameType<RotorDevice>(other);
  isActive_ = rotor.isActive_;
  position_ = rotor.position_;
  direction_ = rotor.direction_;
  value_ = rotor.value_;
  torque_ = rotor.torque_;
  wallEffect_ = rotor.wallEffect_;
  groundEffect_ = rotor.groundEffect_;
}

int RotorDevice::stateSize() const { return rotorStateSize; }

double* RotorDevice::writeState(double* buffer) const {
  *buffer++ = isActive_ ? 1.0 : 0.0;
  for (int i = 0; i < 3; ++i) *buffer++ = position_[i];
  for (int i = 0; i < 3; ++i) *buffer++ = direction_[i];
  for (const Limited* limited : {&value_, &torque_}) {
    *buffer++ = limited->now;
    *buffer++ = limited->min;
    *buffer++ = limited->max;
  }
  for (const Effect* effect : {&wallEffect_, &groundEffect_}) {
    *buffer++ = effect->distance;
    *buffer++ = effect->normMiddleValue;
    *buffer++ = effect->maxRate;
  }
  return buffer;
}

const double* RotorDevice::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  isActive_ = *buffer++ != 0.0;
  for (int i = 0; i < 3; ++i) position_[i] = *buffer++;
  for (int i = 0; i < 3; ++i) direction_[i] = *buffer++;
  for (Limited* limited : {&value_, &torque_}) {
    limited->now = *buffer++;
    limited->min = *buffer++;
    limited->max = *buffer++;
  }
  for (Effect* effect : {&wallEffect_, &groundEffect_}) {
    effect->distance = *buffer++;
    effect->normMiddleValue = *buffer++;
    effect->maxRate = *buffer++;
  }
  return buffer;
}

}  // namespace Multicopter
