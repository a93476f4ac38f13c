#include <cmath>
#include <cnoid/MathUtil>
#include <cnoid/RangeSensor>

#include "device_state_cast.h"
#include "shared_data.h"

namespace cnoid {

namespace {
constexpr int rangeSensorStateSize = 8;
}

void RangeSensor::Sweep::setRange(double newMinAngle, double newMaxAngle) {
  if (!(newMaxAngle >= newMinAngle)) return;
  minAngle = newMinAngle;
  maxAngle = newMaxAngle;
  if (stepDecides) {
    setStep(step);
  } else {
    setSamples(samples);
  }
}

void RangeSensor::Sweep::setStep(double newStep) {
  if (!(newStep >= 0.0)) return;
  step = newStep;
  stepDecides = true;
  // The last beam is included even if rounding makes the quotient a little less than a whole number.
  samples = step == 0.0 ? 1 : static_cast<int>((maxAngle - minAngle) / step + 1.0e-7) + 1;
}

void RangeSensor::Sweep::setSamples(int newSamples) {
  if (newSamples < 1) return;
  samples = newSamples;
  stepDecides = false;
  step = samples == 1 ? 0.0 : (maxAngle - minAngle) / (samples - 1);
}

RangeSensor::RangeSensor() : rangeData_(std::make_shared<RangeData>()) {
  setScanRate(10.0);
  yaw_.setRange(radian(-60.0), radian(60.0));
  yaw_.setStep(1.0);  // [rad]: Choreonoid's default, although one degree was probably intended there
}

RangeSensor::RangeSensor(const RangeSensor& other) = default;

const char* RangeSensor::typeName() const { return "RangeSensor"; }

void RangeSensor::copyStateFrom(const DeviceState& other) {
  const auto& sensor = sameType<RangeSensor>(other);
  copyVisionSensorStateFrom(sensor);
  yaw_ = sensor.yaw_;
  pitch_ = sensor.pitch_;
  minDistance_ = sensor.minDistance_;
  maxDistance_ = sensor.maxDistance_;
  rangeData_ = sensor.rangeData_;
}

Referenced* RangeSensor::doClone(CloneMap*) const {
  auto* sensor = new RangeSensor(*this);
  if (!rangeDataStateClonable_) sensor->clearRangeData();
  return sensor;
}

void RangeSensor::clearState() { clearRangeData(); }

int RangeSensor::stateSize() const { return VisionSensor::stateSize() + rangeSensorStateSize; }

double* RangeSensor::writeState(double* buffer) const {
  buffer = VisionSensor::writeState(buffer);
  buffer[0] = yaw_.minAngle;
  buffer[1] = yaw_.maxAngle;
  buffer[2] = yaw_.samples;
  buffer[3] = pitch_.minAngle;
  buffer[4] = pitch_.maxAngle;
  buffer[5] = pitch_.samples;
  buffer[6] = minDistance_;
  buffer[7] = maxDistance_;
  return buffer + rangeSensorStateSize;
}

const double* RangeSensor::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  buffer = VisionSensor::readState(buffer, size);
  yaw_.setRange(buffer[0], buffer[1]);
  yaw_.setSamples(static_cast<int>(buffer[2]));
  pitch_.setRange(buffer[3], buffer[4]);
  pitch_.setSamples(static_cast<int>(buffer[5]));
  minDistance_ = buffer[6];
  maxDistance_ = buffer[7];
  return buffer + rangeSensorStateSize;
}

void RangeSensor::setYawRange(double angle) { yaw_.setRange(-std::abs(angle) / 2.0, std::abs(angle) / 2.0); }

void RangeSensor::setPitchRange(double angle) { pitch_.setRange(-std::abs(angle) / 2.0, std::abs(angle) / 2.0); }

RangeSensor::RangeData& RangeSensor::rangeData() { return ownData(rangeData_); }

RangeSensor::RangeData& RangeSensor::newRangeData() {
  rangeData_ = std::make_shared<RangeData>();
  return *rangeData_;
}

void RangeSensor::setRangeData(std::shared_ptr<RangeData>& rangeData) { rangeData_ = takeData(rangeData); }

void RangeSensor::clearRangeData() { newRangeData(); }

Vector2 RangeSensor::getSphericalAngle(int rangeDataIndex) const {
  const int yawIndex = rangeDataIndex % yaw_.samples;
  const int pitchIndex = rangeDataIndex / yaw_.samples;
  return Vector2(yaw_.minAngle + yawIndex * yaw_.step, pitch_.minAngle + pitchIndex * pitch_.step);
}

}  // namespace cnoid
