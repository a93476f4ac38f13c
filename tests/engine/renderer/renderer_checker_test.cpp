// Squares of a second colour on shapes.
#include "scene.h"

namespace rehearse {
namespace {

Shape checkered(Shape shape, double size, const Color& color = green) {
  shape.checker = Checker{color, size};
  return shape;
}

/// The colour of a point of the shape: the first if an even number of its coordinates are in odd cells.
Hue expected_at(const Eigen::Vector3d& point, double size) {
  const Eigen::Vector3d cell = (point / size).array().floor();
  return std::fmod(std::abs(cell.sum()), 2.0) == 0.0 ? Hue::reddish : Hue::greenish;
}

/// Compares the colour of every pixel that shows the shape and isn't near an edge of a square; where the shape turns
/// away from the camera a few pixels show both colours. Returns the number of compared pixels.
int expect_squares(const Shape& shape, const Eigen::Isometry3d& pose) {
  const Camera camera = camera_of(120, 120, 0.8);
  const auto renderer = make_renderer();
  renderer->add(shape, red);
  const Frame frame = renderer->draw(camera, pose);
  const double per_pixel = 2.0 * std::tan(0.5 * camera.field_of_view) / camera.height;
  int compared = 0, mixed = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double depth = meters(frame.depth, x, y);
      if (!std::isfinite(depth)) continue;
      const Eigen::Vector3d ray(per_pixel * (x + 0.5 - 60.0), per_pixel * (60.0 - y - 0.5), -1.0);
      const Eigen::Vector3d point = shape.pose.inverse() * (pose * Eigen::Vector3d(depth * ray));
      const Eigen::Array3d cells = point.array() / shape.checker->size;
      if (((cells - cells.round()).abs() < 0.1).any()) continue;
      const Hue seen = hue(pixel(frame.color, x, y));
      if (seen == Hue::none) {
        ++mixed;
        continue;
      }
      EXPECT_EQ(seen, expected_at(point, shape.checker->size)) << x << ", " << y;
      ++compared;
    }
  }
  EXPECT_LT(mixed, 0.02 * compared);
  return compared;
}

const Eigen::Isometry3d view = look_at({2.0, -1.5, 1.6}, {0.1, 0.0, 0.3});

TEST(RendererChecker, LiesAboutTheShapesOwnAxesFromItsCentre) {
  Shape box = checkered(shape_at(Box{{0.9, 0.7, 0.5}}, {0.1, 0.1, 0.3}), 0.2);
  box.pose.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()));
  EXPECT_GT(expect_squares(box, view), 1000);
  Shape cylinder = checkered(shape_at(Cylinder{0.4, 0.7}, {0.1, 0.1, 0.3}), 0.3);
  cylinder.pose.rotate(Eigen::AngleAxisd(-0.5, Eigen::Vector3d(3, 1, 0).normalized()));
  EXPECT_GT(expect_squares(cylinder, view), 500);
  EXPECT_GT(expect_squares(checkered(shape_at(Sphere{0.5}, {0.1, 0.1, 0.3}), 0.4), view), 500);
  EXPECT_GT(expect_squares(checkered(shape_at(Capsule{0.3, 0.4}, {0.1, 0.1, 0.3}), 0.4), view), 500);
}

TEST(RendererChecker, IsWholeOnAFaceThatLiesOnTheEdgesOfItsSquares) {
  const auto renderer = make_renderer();
  renderer->add(checkered(shape_at(Box{{4, 4, 1}}, {0, 0, -0.5}), 0.5), red);
  const Image image = renderer->draw(camera_of(64, 64, 0.2), look_at({0.25, 0.25, 2}, {0.25, 0.25, 0})).color;
  for (int y = 0; y < 64; ++y)  // of 0.4 m each way: one square, from its middle
    for (int x = 0; x < 64; ++x) EXPECT_EQ(pixel(image, x, y), pixel(image, 32, 32)) << x << ", " << y;
}

TEST(RendererChecker, BecomesTheMeanWhereItIsFinerThanThePixels) {
  const Camera camera = camera_of(64, 48, 0.6);
  const Eigen::Isometry3d pose = look_at({0, 0, 10}, {0.3, 0.1, 0});
  const auto checker = make_renderer(), even = make_renderer();
  checker->add(checkered(shape_at(Box{{40, 40, 1}}, {0, 0, -0.5}), 0.01, Color(0, 0, 0, 1)), {1, 1, 1, 1});
  even->add(shape_at(Box{{40, 40, 1}}, {0, 0, -0.5}), {0.5f, 0.5f, 0.5f, 1});
  const Image image = checker->draw(camera, pose).color, expected = even->draw(camera, pose).color;
  for (std::size_t i = 0; i < image.pixels.size(); ++i) ASSERT_NEAR(image.pixels[i], expected.pixels[i], 1) << i;
}

TEST(RendererChecker, HasTheOpacityOfItsShape) {
  const auto renderer = make_renderer();
  renderer->add(checkered(shape_at(Box{{1, 1, 1}}, {0, 0, -3}), 0.05), {1, 0, 0, 0.5f});
  renderer->add(shape_at(Box{{5, 5, 1}}, {0, 0, -6}), blue);
  const Image image = renderer->draw(camera_of(20, 20, 0.2), Eigen::Isometry3d::Identity()).color;
  for (int x = 0; x < 20; ++x) EXPECT_GT(pixel(image, x, 10)[2], 50) << x;
}

TEST(RendererChecker, ChangesNothingOnOtherShapes) {
  const auto alone = make_renderer(), beside = make_renderer();
  beside->add(checkered(shape_at(Box{{1, 1, 1}}, {0, 0, 30}), 0.1), red);  // behind the camera
  for (Renderer* renderer : {alone.get(), beside.get()}) {
    renderer->add(shape_at(Sphere{0.5}, {0, 0, -2}), grey);
    renderer->add(shape_at(Box{{5, 5, 1}}, {0, 0, -6}), blue);
  }
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  EXPECT_TRUE(beside->draw(camera_of(64, 48), pose).color.pixels == alone->draw(camera_of(64, 48), pose).color.pixels);
}

}  // namespace
}  // namespace rehearse
