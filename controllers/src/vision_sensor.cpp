#include <cnoid/VisionSensor>
#include <stdexcept>
#include <string>

namespace cnoid {

namespace {
constexpr int visionSensorStateSize = 3;
}

VisionSensor::VisionSensor() : R_optical_(Matrix3::Identity()) {}

bool VisionSensor::on() const { return on_; }

void VisionSensor::on(bool on) { on_ = on; }

void VisionSensor::copyVisionSensorStateFrom(const VisionSensor& other) {
  on_ = other.on_;
  frameRate_ = other.frameRate_;
  delay_ = other.delay_;
}

Matrix3 VisionSensor::opticalFrameRotationOfType(int opticalFrameType) {
  Matrix3 rotation;  // columns: the axes of the GL frame in each of them
  switch (opticalFrameType) {
    case GL: return Matrix3::Identity();
    case CV: return Vector3(1, -1, -1).asDiagonal();
    case Robotics: rotation << 0, 0, -1, -1, 0, 0, 0, 1, 0; return rotation;
    default: throw std::invalid_argument("no optical frame has the number " + std::to_string(opticalFrameType));
  }
}

int VisionSensor::stateSize() const { return visionSensorStateSize; }

double* VisionSensor::writeState(double* buffer) const {
  buffer[0] = on_ ? 1.0 : 0.0;
  buffer[1] = frameRate_;
  buffer[2] = delay_;
  return buffer + visionSensorStateSize;
}

const double* VisionSensor::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  on_ = buffer[0] != 0.0;
  frameRate_ = buffer[1];
  delay_ = buffer[2];
  return buffer + visionSensorStateSize;
}

}  // namespace cnoid
