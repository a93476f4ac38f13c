#include <cnoid/ZmpDevice>

#include "device_state_cast.h"

namespace cnoid {

ZmpDevice::ZmpDevice() : zmp_(Vector3::Zero()) {}

Referenced* ZmpDevice::doClone(CloneMap*) const { return new ZmpDevice(*this); }

const char* ZmpDevice::typeName() const { return "ZmpDevice"; }

void ZmpDevice::copyStateFrom(const DeviceState& other) {
  const auto& zmp = sameType<ZmpDevice>(other);
  on_ = zmp.on_;
  zmp_ = zmp.zmp_;
}

void ZmpDevice::clearState() { zmp_.setZero(); }

int ZmpDevice::stateSize() const { return 4; }

double* ZmpDevice::writeState(double* buffer) const {
  buffer[0] = on_ ? 1.0 : 0.0;
  Eigen::Map<Vector3>(buffer + 1) = zmp_;
  return buffer + stateSize();
}

const double* ZmpDevice::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  on_ = buffer[0] != 0.0;
  zmp_ = Eigen::Map<const Vector3>(buffer + 1);
  return buffer + stateSize();
}

}  // namespace cnoid
