#include <cnoid/BasicSensors>
#include <limits>

#include "device_state_cast.h"

namespace cnoid {

namespace {

constexpr double noLimit = std::numeric_limits<double>::max();

/// Copies a vector of a device's state from, or into, the flat buffer, and returns a pointer behind it.
template <class Vector>
const double* readVector(const double* buffer, Vector& vector) {
  vector = Eigen::Map<const Vector>(buffer);
  return buffer + vector.size();
}
template <class Vector>
double* writeVector(double* buffer, const Vector& vector) {
  Eigen::Map<Vector> target(buffer);
  target = vector;
  return buffer + vector.size();
}

}  // namespace

ForceSensor::ForceSensor() : F_(Vector6::Zero()), F_max_(Vector6::Constant(noLimit)) {}
const char* ForceSensor::typeName() const { return "ForceSensor"; }
void ForceSensor::copyStateFrom(const DeviceState& other) { F_ = sameType<ForceSensor>(other).F_; }
void ForceSensor::clearState() { F_.setZero(); }
int ForceSensor::stateSize() const { return 6; }
double* ForceSensor::writeState(double* buffer) const { return writeVector(buffer, F_); }
const double* ForceSensor::readState(const double* buffer, int size) {
  return size < stateSize() ? buffer : readVector(buffer, F_);
}
Referenced* ForceSensor::doClone(CloneMap*) const { return new ForceSensor(*this); }

RateGyroSensor::RateGyroSensor() : w_(Vector3::Zero()), w_max_(Vector3::Constant(noLimit)) {}
const char* RateGyroSensor::typeName() const { return "RateGyroSensor"; }
void RateGyroSensor::copyStateFrom(const DeviceState& other) { w_ = sameType<RateGyroSensor>(other).w_; }
void RateGyroSensor::clearState() { w_.setZero(); }
int RateGyroSensor::stateSize() const { return 3; }
double* RateGyroSensor::writeState(double* buffer) const { return writeVector(buffer, w_); }
const double* RateGyroSensor::readState(const double* buffer, int size) {
  return size < stateSize() ? buffer : readVector(buffer, w_);
}
Referenced* RateGyroSensor::doClone(CloneMap*) const { return new RateGyroSensor(*this); }

AccelerationSensor::AccelerationSensor() : dv_(Vector3::Zero()), dv_max_(Vector3::Constant(noLimit)) {}
const char* AccelerationSensor::typeName() const { return "AccelerationSensor"; }
void AccelerationSensor::copyStateFrom(const DeviceState& other) { dv_ = sameType<AccelerationSensor>(other).dv_; }
void AccelerationSensor::clearState() { dv_.setZero(); }
int AccelerationSensor::stateSize() const { return 3; }
double* AccelerationSensor::writeState(double* buffer) const { return writeVector(buffer, dv_); }
const double* AccelerationSensor::readState(const double* buffer, int size) {
  return size < stateSize() ? buffer : readVector(buffer, dv_);
}
Referenced* AccelerationSensor::doClone(CloneMap*) const { return new AccelerationSensor(*this); }

Imu::Imu()
    : w_(Vector3::Zero()),
      dv_(Vector3::Zero()),
      w_max_(Vector3::Constant(noLimit)),
      dv_max_(Vector3::Constant(noLimit)) {}
const char* Imu::typeName() const { return "Imu"; }
void Imu::copyStateFrom(const DeviceState& other) {
  const Imu& imu = sameType<Imu>(other);
  w_ = imu.w_;
  dv_ = imu.dv_;
}
void Imu::clearState() {
  w_.setZero();
  dv_.setZero();
}
int Imu::stateSize() const { return 6; }
double* Imu::writeState(double* buffer) const { return writeVector(writeVector(buffer, w_), dv_); }
const double* Imu::readState(const double* buffer, int size) {
  return size < stateSize() ? buffer : readVector(readVector(buffer, w_), dv_);
}
Referenced* Imu::doClone(CloneMap*) const { return new Imu(*this); }

}  // namespace cnoid
