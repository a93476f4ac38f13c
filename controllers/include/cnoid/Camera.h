// Camera: colour images, three bytes per pixel, top row first.
//
// The simulated camera, the controller's camera and other owners share images: constImage() and sharedImage() never
// copy. image() of a camera that is not const makes a copy first if the image has other owners, so that writing to it
// is safe.
#pragma once

#include "Image.h"
#include "VisionSensor.h"

#include <memory>

namespace cnoid {

class CNOID_GENERAL_EXPORT Camera : public VisionSensor {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  Camera();

  const char* typeName() const override;
  void copyStateFrom(const DeviceState& other) override;
  void clearState() override;
  int stateSize() const override;
  double* writeState(double* buffer) const override;  // VisionSensor's; width, height, near, far, field of view
  const double* readState(const double* buffer, int size) override;

  enum ImageType { NO_IMAGE, COLOR_IMAGE, GRAYSCALE_IMAGE };
  ImageType imageType() const { return imageType_; }
  void setImageType(ImageType type) { imageType_ = type; }

  enum LensType { NORMAL_LENS, FISHEYE_LENS, DUAL_FISHEYE_LENS };
  LensType lensType() const { return lensType_; }
  void setLensType(LensType type) { lensType_ = type; }

  int resolutionX() const { return resolutionX_; }  // [pixels]
  int resolutionY() const { return resolutionY_; }  // [pixels]
  void setResolution(int x, int y) {
    resolutionX_ = x;
    resolutionY_ = y;
  }
  void setResolutionX(int x) { resolutionX_ = x; }
  void setResolutionY(int y) { resolutionY_ = y; }

  double nearClipDistance() const { return nearClipDistance_; }  // [m]
  void setNearClipDistance(double distance) { nearClipDistance_ = distance; }
  double nearDistance() const { return nearClipDistance_; }  // old names
  void setNearDistance(double distance) { nearClipDistance_ = distance; }
  double farDistance() const { return farClipDistance_; }
  void setFarDistance(double distance) { farClipDistance_ = distance; }
  double farClipDistance() const { return farClipDistance_; }  // [m]
  void setFarClipDistance(double distance) { farClipDistance_ = distance; }

  /// The vertical angle if the image is at least as wide as it is high, else the horizontal one [rad].
  double fieldOfView() const { return fieldOfView_; }
  void setFieldOfView(double angle) { fieldOfView_ = angle; }
  /// The horizontal angle [rad], by the resolution set before. Exact: tan(h/2) = width/height * tan(v/2).
  double horizontalFieldOfView() const;
  void setHorizontalFieldOfView(double angle);

  /// Empty until the first image is delivered.
  const Image& image() const { return *image_; }
  const Image& constImage() const { return *image_; }
  Image& image();
  std::shared_ptr<const Image> sharedImage() const { return image_; }

  /// Creates a new, empty image to be filled.
  Image& newImage();
  /// Takes the image without copying if the caller is its only owner, else copies it. Leaves `image` null.
  void setImage(std::shared_ptr<Image>& image);
  void clearImage();

  /// If true, clone() copies the image, too; false by default.
  bool isImageStateClonable() const { return imageStateClonable_; }
  void setImageStateClonable(bool on) { imageStateClonable_ = on; }

 protected:
  Camera(const Camera& other);
  void copyCameraStateFrom(const Camera& other);
  Referenced* doClone(CloneMap* cloneMap) const override;

 private:
  ImageType imageType_ = COLOR_IMAGE;
  LensType lensType_ = NORMAL_LENS;
  int resolutionX_ = 640;
  int resolutionY_ = 480;
  double nearClipDistance_ = 0.04;
  double farClipDistance_ = 200.0;
  double fieldOfView_ = 0.785398;
  bool imageStateClonable_ = false;
  std::shared_ptr<Image> image_;
};

using CameraPtr = ref_ptr<Camera>;

}  // namespace cnoid
