// The points behind a camera's pixels.

#include <rehearse/renderer.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model/pinhole.h"

namespace rehearse {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();

Camera camera_of(int width, int height, double field_of_view) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.field_of_view = field_of_view;
  camera.depth = true;
  return camera;
}

std::vector<Eigen::Vector3f> points_at(const Camera& camera, float distance) {
  const std::size_t pixels = static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  std::vector<Eigen::Vector3f> points;
  points_from_depth(camera, {camera.width, camera.height, std::vector<float>(pixels, distance)}, points);
  return points;
}

TEST(Pinhole, TheFieldOfViewIsTheVerticalOneInALandscapePicture) {
  EXPECT_EQ(vertical_field_of_view(camera_of(640, 480, 1.0)), 1.0);
  EXPECT_EQ(vertical_field_of_view(camera_of(480, 480, 1.0)), 1.0);
}

TEST(Pinhole, TheFieldOfViewIsTheHorizontalOneInAPortraitPicture) {
  EXPECT_NEAR(vertical_field_of_view(camera_of(240, 480, M_PI / 2)), 2.0 * std::atan(2.0), 1e-12);
}

TEST(Pinhole, PointsLieBehindThePixelsCentres) {
  const auto points = points_at(camera_of(4, 2, M_PI / 2), 3.0f);  // 6 m high, 12 m wide, 3 m away
  ASSERT_EQ(points.size(), 8u);
  EXPECT_EQ(points[0], Eigen::Vector3f(-4.5f, 1.5f, -3.0f));  // top left first
  EXPECT_EQ(points[3], Eigen::Vector3f(4.5f, 1.5f, -3.0f));
  EXPECT_EQ(points[7], Eigen::Vector3f(4.5f, -1.5f, -3.0f));
}

TEST(Pinhole, WhatWasNotHitIsInfinitelyFarOnItsSideOfTheCentre) {
  const auto points = points_at(camera_of(3, 3, 1.0), inf);
  EXPECT_EQ(points[0], Eigen::Vector3f(-inf, inf, inf));
  EXPECT_EQ(points[1], Eigen::Vector3f(0, inf, inf));
  EXPECT_EQ(points[3], Eigen::Vector3f(-inf, 0, inf));
  EXPECT_EQ(points[4], Eigen::Vector3f(0, 0, inf));
  EXPECT_EQ(points[8], Eigen::Vector3f(inf, -inf, inf));
}

TEST(Pinhole, PointsOfAPlaneLieInThePlane) {
  auto renderer = Renderer::create();
  ASSERT_TRUE(renderer.ok());
  // A wall whose front is the plane through (0, 0, -2) with this normal, in the camera's frame.
  const Eigen::Vector3d normal = Eigen::Vector3d(0.4, -0.3, 1.0).normalized();
  Shape wall{"", Box{{20, 20, 1}}, Eigen::Isometry3d::Identity(), {}, {}};
  wall.pose.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
  wall.pose.translation() = Eigen::Vector3d(0, 0, -2) - 0.5 * normal;
  (*renderer)->add(wall, Color(1, 1, 1, 1));
  const Camera camera = camera_of(64, 48, 0.9);
  const Frame frame = (*renderer)->draw(camera, Eigen::Isometry3d::Identity());
  std::vector<Eigen::Vector3f> points;
  points_from_depth(camera, frame.depth, points);
  ASSERT_EQ(points.size(), 64u * 48u);
  for (const Eigen::Vector3f& point : points) {
    const double off = normal.dot(point.cast<double>() - Eigen::Vector3d(0, 0, -2));
    ASSERT_LT(std::abs(off), 1e-3 + 1e-3 * std::abs(point.z()));
  }
}

TEST(Pinhole, TheSizeOfThePointsFollowsThePicture) {
  std::vector<Eigen::Vector3f> points(100);
  points_from_depth(camera_of(2, 1, 1.0), {2, 1, {1.0f, inf}}, points);
  EXPECT_EQ(points.size(), 2u);
}

}  // namespace
}  // namespace rehearse
