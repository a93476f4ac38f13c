#include <gtest/gtest.h>
#include <cnoid/RangeCamera>

#include <cmath>
#include <stdexcept>

namespace {

using cnoid::Camera;
using cnoid::CameraPtr;
using cnoid::Image;
using cnoid::Matrix3;
using cnoid::RangeCamera;
using cnoid::RangeCameraPtr;
using cnoid::Vector3;
using cnoid::VisionSensor;

std::shared_ptr<Image> red_pixel() {
  auto image = std::make_shared<Image>();
  image->setSize(1, 1, 3);
  image->pixels()[0] = 255;
  return image;
}

TEST(Camera, HasChoreonoidsDefaults) {
  const CameraPtr camera = new Camera;
  EXPECT_EQ(camera->resolutionX(), 640);
  EXPECT_EQ(camera->resolutionY(), 480);
  EXPECT_EQ(camera->fieldOfView(), 0.785398);
  EXPECT_EQ(camera->nearClipDistance(), 0.04);
  EXPECT_EQ(camera->farClipDistance(), 200.0);
  EXPECT_EQ(camera->frameRate(), 30.0);
  EXPECT_EQ(camera->imageType(), Camera::COLOR_IMAGE);
  EXPECT_EQ(camera->lensType(), Camera::NORMAL_LENS);
  EXPECT_TRUE(camera->constImage().empty());
}

TEST(Camera, TakesAnImageOverWithoutCopyingIt) {
  const CameraPtr camera = new Camera;
  std::shared_ptr<Image> image = red_pixel();
  const Image* address = image.get();
  camera->setImage(image);
  EXPECT_EQ(&camera->constImage(), address);
  EXPECT_EQ(image, nullptr);
}

TEST(Camera, CopiesAnImageThatOthersHold) {
  const CameraPtr camera = new Camera;
  const std::shared_ptr<Image> kept = red_pixel();
  std::shared_ptr<Image> given = kept;
  camera->setImage(given);
  kept->pixels()[0] = 7;
  EXPECT_EQ(camera->constImage().pixels()[0], 255);
  EXPECT_EQ(given, nullptr);
}

TEST(Camera, SharesItsImageWithACopyOfItsState) {
  const CameraPtr simulated = new Camera;
  const CameraPtr seen = new Camera;
  std::shared_ptr<Image> image = red_pixel();
  simulated->setImage(image);
  seen->copyStateFrom(*simulated);
  EXPECT_EQ(&seen->constImage(), &simulated->constImage());
}

TEST(Camera, WritesToAnImageOfItsOwn) {
  const CameraPtr camera = new Camera;
  std::shared_ptr<Image> image = red_pixel();
  camera->setImage(image);
  const std::shared_ptr<const Image> recorded = camera->sharedImage();
  camera->image().pixels()[0] = 7;
  EXPECT_EQ(recorded->pixels()[0], 255);
  EXPECT_EQ(camera->constImage().pixels()[0], 7);
}

TEST(Camera, LeavesItsImageBehindWhenClonedUnlessToldOtherwise) {
  const CameraPtr camera = new Camera;
  std::shared_ptr<Image> image = red_pixel();
  camera->setImage(image);
  EXPECT_TRUE(CameraPtr(static_cast<Camera*>(camera->clone()))->constImage().empty());
  camera->setImageStateClonable(true);
  EXPECT_FALSE(CameraPtr(static_cast<Camera*>(camera->clone()))->constImage().empty());
}

TEST(Camera, HasNoImageAfterItsStateIsCleared) {
  const CameraPtr camera = new Camera;
  std::shared_ptr<Image> image = red_pixel();
  camera->setImage(image);
  camera->clearState();
  EXPECT_TRUE(camera->constImage().empty());
}

TEST(Camera, ConvertsBetweenTheFieldsOfViewExactly) {
  const CameraPtr camera = new Camera;
  camera->setResolution(200, 100);
  camera->setHorizontalFieldOfView(2.0 * std::atan(1.0));  // 90 degrees
  EXPECT_DOUBLE_EQ(camera->fieldOfView(), 2.0 * std::atan(0.5));
  EXPECT_DOUBLE_EQ(camera->horizontalFieldOfView(), 2.0 * std::atan(1.0));
}

TEST(Camera, HasTheHorizontalFieldOfViewInPortrait) {
  const CameraPtr camera = new Camera;
  camera->setResolution(100, 200);
  camera->setHorizontalFieldOfView(0.5);
  EXPECT_EQ(camera->fieldOfView(), 0.5);
  EXPECT_EQ(camera->horizontalFieldOfView(), 0.5);
}

TEST(VisionSensor, LooksAlongTheAxisOfItsOpticalFrame) {
  const Vector3 forward(0, 0, -1);  // of the GL frame
  const Vector3 up(0, 1, 0);
  const Matrix3 cv = VisionSensor::opticalFrameRotationOfType(VisionSensor::CV);
  EXPECT_EQ(cv * forward, Vector3(0, 0, 1));
  EXPECT_EQ(cv * up, Vector3(0, -1, 0));
  const Matrix3 robotics = VisionSensor::opticalFrameRotationOfType(VisionSensor::Robotics);
  EXPECT_EQ(robotics * forward, Vector3(1, 0, 0));
  EXPECT_EQ(robotics * up, Vector3(0, 0, 1));
  EXPECT_THROW(VisionSensor::opticalFrameRotationOfType(3), std::invalid_argument);
}

TEST(RangeCamera, MeasuresPointsAndNoImageByDefault) {
  const RangeCameraPtr camera = new RangeCamera;
  EXPECT_EQ(camera->imageType(), Camera::NO_IMAGE);
  EXPECT_TRUE(camera->isOrganized());
  EXPECT_EQ(camera->numPoints(), 0);
  EXPECT_EQ(camera->maxDistance(), 10.0);
}

TEST(RangeCamera, SharesItsPointsWithACopyOfItsState) {
  const RangeCameraPtr simulated = new RangeCamera;
  const RangeCameraPtr seen = new RangeCamera;
  auto points = std::make_shared<RangeCamera::PointData>(2, cnoid::Vector3f(1, 2, 3));
  simulated->setPoints(points);
  seen->copyStateFrom(*simulated);
  EXPECT_EQ(seen->numPoints(), 2);
  EXPECT_EQ(&seen->constPoints(), &simulated->constPoints());
  seen->points()[0].x() = 9;
  EXPECT_EQ(simulated->constPoints()[0].x(), 1.0f);
}

TEST(RangeCamera, LosesWhatItHasWhenTheFormOfItsCloudChanges) {
  const RangeCameraPtr camera = new RangeCamera;
  camera->newPoints().resize(4);
  camera->setOrganized(true);
  EXPECT_EQ(camera->numPoints(), 4);
  camera->setOrganized(false);
  EXPECT_EQ(camera->numPoints(), 0);
}

TEST(RangeCamera, RefusesTheStateOfAPlainCamera) {
  const RangeCameraPtr range_camera = new RangeCamera;
  const CameraPtr camera = new Camera;
  EXPECT_THROW(range_camera->copyStateFrom(*camera), std::invalid_argument);
  EXPECT_THROW(camera->copyStateFrom(*range_camera), std::invalid_argument);
}

}  // namespace
