#include <cnoid/MarkerDevice>

#include "device_state_cast.h"

namespace cnoid {

namespace {
constexpr int markerStateSize = 15;
}

MarkerDevice::MarkerDevice() : color_(1.0f, 0.0f, 0.0f), offsetPosition_(Isometry3::Identity()) {}

Referenced* MarkerDevice::doClone(CloneMap*) const { return new MarkerDevice(*this); }

const char* MarkerDevice::typeName() const { return "MarkerDevice"; }

void MarkerDevice::copyStateFrom(const DeviceState& other) {
  const auto& marker = sameType<MarkerDevice>(other);
  on_ = marker.on_;
  markerType_ = marker.markerType_;
  markerSize_ = marker.markerSize_;
  color_ = marker.color_;
  emission_ = marker.emission_;
  transparency_ = marker.transparency_;
  offsetPosition_ = marker.offsetPosition_;
}

int MarkerDevice::stateSize() const { return markerStateSize; }

double* MarkerDevice::writeState(double* buffer) const {
  buffer[0] = on_ ? 1.0 : 0.0;
  buffer[1] = markerType_;
  buffer[2] = markerSize_;
  for (int i = 0; i < 3; ++i) buffer[3 + i] = color_[i];
  buffer[6] = emission_;
  buffer[7] = transparency_;
  for (int i = 0; i < 3; ++i) buffer[8 + i] = offsetPosition_.translation()[i];
  const Quaternion rotation(offsetPosition_.linear());
  buffer[11] = rotation.w();
  for (int i = 0; i < 3; ++i) buffer[12 + i] = rotation.vec()[i];
  return buffer + markerStateSize;
}

const double* MarkerDevice::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  on_ = buffer[0] != 0.0;
  markerType_ = static_cast<int>(buffer[1]);
  markerSize_ = buffer[2];
  color_ = Eigen::Map<const Vector3>(buffer + 3).cast<float>();
  emission_ = static_cast<float>(buffer[6]);
  transparency_ = static_cast<float>(buffer[7]);
  offsetPosition_.translation() = Eigen::Map<const Vector3>(buffer + 8);
  offsetPosition_.linear() = Quaternion(buffer[11], buffer[12], buffer[13], buffer[14]).normalized().toRotationMatrix();
  return buffer + markerStateSize;
}

bool MarkerDevice::on() const { return on_; }

void MarkerDevice::on(bool on) { on_ = on; }

}  // namespace cnoid
