#include <cmath>
#include <cnoid/Camera>

#include "device_state_cast.h"
#include "shared_data.h"

namespace cnoid {

namespace {

constexpr int cameraStateSize = 5;

/// The angle whose half-tangent is `ratio` times that of `angle`: converts fields of view across and along an image.
double scaleFieldOfView(double angle, double ratio) { return 2.0 * std::atan(ratio * std::tan(angle / 2.0)); }

}  // namespace

Camera::Camera() : image_(std::make_shared<Image>()) {}

Camera::Camera(const Camera& other) : VisionSensor(other), imageStateClonable_(other.imageStateClonable_) {
  copyCameraStateFrom(other);
  if (!imageStateClonable_) image_ = std::make_shared<Image>();
}

const char* Camera::typeName() const { return "Camera"; }

void Camera::copyStateFrom(const DeviceState& other) { copyCameraStateFrom(sameType<Camera>(other)); }

void Camera::copyCameraStateFrom(const Camera& other) {
  copyVisionSensorStateFrom(other);
  imageType_ = other.imageType_;
  lensType_ = other.lensType_;
  resolutionX_ = other.resolutionX_;
  resolutionY_ = other.resolutionY_;
  nearClipDistance_ = other.nearClipDistance_;
  farClipDistance_ = other.farClipDistance_;
  fieldOfView_ = other.fieldOfView_;
  image_ = other.image_;
}

Referenced* Camera::doClone(CloneMap*) const { return new Camera(*this); }

void Camera::clearState() { clearImage(); }

int Camera::stateSize() const { return VisionSensor::stateSize() + cameraStateSize; }

double* Camera::writeState(double* buffer) const {
  buffer = VisionSensor::writeState(buffer);
  buffer[0] = resolutionX_;
  buffer[1] = resolutionY_;
  buffer[2] = nearClipDistance_;
  buffer[3] = farClipDistance_;
  buffer[4] = fieldOfView_;
  return buffer + cameraStateSize;
}

const double* Camera::readState(const double* buffer, int size) {
  if (size < stateSize()) return buffer;
  buffer = VisionSensor::readState(buffer, size);
  resolutionX_ = static_cast<int>(buffer[0]);
  resolutionY_ = static_cast<int>(buffer[1]);
  nearClipDistance_ = buffer[2];
  farClipDistance_ = buffer[3];
  fieldOfView_ = buffer[4];
  return buffer + cameraStateSize;
}

double Camera::horizontalFieldOfView() const {
  if (resolutionX_ < resolutionY_) return fieldOfView_;
  return scaleFieldOfView(fieldOfView_, static_cast<double>(resolutionX_) / resolutionY_);
}

void Camera::setHorizontalFieldOfView(double angle) {
  const double ratio = static_cast<double>(resolutionY_) / resolutionX_;
  fieldOfView_ = resolutionX_ < resolutionY_ ? angle : scaleFieldOfView(angle, ratio);
}

Image& Camera::image() { return ownData(image_); }

Image& Camera::newImage() {
  image_ = std::make_shared<Image>();
  return *image_;
}

void Camera::setImage(std::shared_ptr<Image>& image) { image_ = takeData(image); }

void Camera::clearImage() { newImage(); }

}  // namespace cnoid
