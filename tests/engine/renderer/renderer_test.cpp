#include "scene.h"

#include <xmmintrin.h>

#include <numbers>
#include <string>

namespace rehearse {
namespace {

/// A scene with several kinds of shapes, for pictures that are only compared with each other.
std::unique_ptr<Renderer> make_scene() {
  auto renderer = make_renderer();
  renderer->add(shape_at(Box{{10, 10, 0.2}}, {0, 0, -0.1}), blue);
  renderer->add(shape_at(Sphere{0.3}, {0, 0.2, 0.3}), red);
  renderer->add(shape_at(Cylinder{0.1, 0.8}, {0.4, -0.3, 0.4}), green);
  renderer->add(shape_at(Capsule{0.1, 0.3}, {0.5, 0.3, 0.3}), {0.9f, 0.9f, 0.2f, 0.5f});
  return renderer;
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.color.width, b.color.width);
  EXPECT_EQ(a.color.height, b.color.height);
  EXPECT_TRUE(a.color.pixels == b.color.pixels);
  EXPECT_TRUE(a.depth.meters == b.depth.meters);
}

TEST(Renderer, ShowsTheSkyWhereNothingIs) {
  const auto renderer = make_renderer({Color(0.2f, 0.4f, 0.6f, 1.0f)});
  const Image image = renderer->draw(camera_of(3, 2), at_origin).color;
  ASSERT_EQ(image.pixels.size(), 18u);
  EXPECT_EQ(pixel(image, 2, 1), (std::array{51, 102, 153}));
}

TEST(Renderer, ShowsLeftOnTheLeftAndUpAbove) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{0.4, 0.4, 0.4}}, {-1, 0, -4}), red);
  renderer->add(shape_at(Box{{0.4, 0.4, 0.4}}, {1, 0, -4}), green);
  renderer->add(shape_at(Box{{0.4, 0.4, 0.4}}, {0, 1, -4}), blue);
  const double fov = 2.0 * std::atan(0.5);  // 4 m wide and high at 4 m
  const Image image = renderer->draw(camera_of(40, 40, fov), at_origin).color;
  EXPECT_EQ(hue(pixel(image, 10, 20)), Hue::reddish);
  EXPECT_EQ(hue(pixel(image, 30, 20)), Hue::greenish);
  EXPECT_EQ(hue(pixel(image, 20, 10)), Hue::bluish);
  EXPECT_EQ(hue(pixel(image, 20, 30)), Hue::none);
}

TEST(Renderer, HidesWhatIsBehindWhicheverWasAddedFirst) {
  for (const bool near_first : {true, false}) {
    const auto renderer = make_renderer();
    if (near_first) renderer->add(shape_at(Sphere{0.5}, {0, 0, -3}), red);
    renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, -6}), blue);
    if (!near_first) renderer->add(shape_at(Sphere{0.5}, {0, 0, -3}), red);
    EXPECT_EQ(hue(pixel(renderer->draw(camera_of(1, 1, 0.1), at_origin).color, 0, 0)), Hue::reddish);
  }
}

TEST(Renderer, LooksOutOfAShapeThatTheCameraIsIn) {
  for (const Geometry& geometry :
       {Geometry(Box{{1, 1, 1}}), Geometry(Sphere{1}), Geometry(Cylinder{1, 1}), Geometry(Capsule{1, 1})}) {
    const auto renderer = make_renderer();
    renderer->add(shape_at(geometry, {0, 0, 0}), red);
    renderer->add(shape_at(Box{{5, 5, 1}}, {0, 0, -6}), blue);
    EXPECT_EQ(hue(pixel(renderer->draw(camera_of(1, 1), at_origin).color, 0, 0)), Hue::bluish) << geometry.index();
  }
}

TEST(Renderer, UsesTheShapesOwnColourBeforeTheDefault) {
  const auto renderer = make_renderer();
  Shape shape = shape_at(Box{{1, 1, 1}}, {0, 0, -3});
  shape.color = green;
  renderer->add(shape, red);
  EXPECT_EQ(hue(pixel(renderer->draw(camera_of(1, 1, 0.1), at_origin).color, 0, 0)), Hue::greenish);
}

TEST(Renderer, PlacesAShapeByItsLinkThenByItsOwnPose) {
  const auto renderer = make_renderer();
  const int number = renderer->add(shape_at(Box{{1, 1, 1}}, {4.0, 0, 0}), red);
  Eigen::Isometry3d link = Eigen::Isometry3d::Identity();
  link.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY()));  // x becomes -z
  link.translation() = Eigen::Vector3d(0, 0, -1);
  renderer->set_link_pose(number, link);
  EXPECT_NEAR(renderer->draw(camera_of(1, 1, 0.1), at_origin).depth.meters[0], 4.5, 0.006);
}

/// True if the middle of the top row (or of the leftmost column) shows a bar that reaches `half_extent` from the axis
/// at 1 m. The camera has a field of view of 0.8 rad.
bool reaches_the_edge(int width, int height, const Eigen::Vector3d& bar_size, bool top) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{bar_size}, {0, 0, -1.0 - 0.5 * bar_size.z()}), red);
  const Image image = renderer->draw(camera_of(width, height, 0.8), at_origin).color;
  return hue(top ? pixel(image, width / 2, 0) : pixel(image, 0, height / 2)) == Hue::reddish;
}

TEST(Renderer, FieldOfViewIsVerticalInLandscape) {
  const double extent = 2.0 * std::tan(0.4);
  EXPECT_TRUE(reaches_the_edge(300, 200, {0.1, 1.00 * extent, 0.1}, true));
  EXPECT_FALSE(reaches_the_edge(300, 200, {0.1, 0.99 * extent, 0.1}, true));
  EXPECT_TRUE(reaches_the_edge(300, 200, {1.5 * extent, 0.1, 0.1}, false));
  EXPECT_FALSE(reaches_the_edge(300, 200, {1.485 * extent, 0.1, 0.1}, false));
}

TEST(Renderer, FieldOfViewIsHorizontalInPortrait) {
  const double extent = 2.0 * std::tan(0.4);
  EXPECT_TRUE(reaches_the_edge(200, 300, {1.00 * extent, 0.1, 0.1}, false));
  EXPECT_FALSE(reaches_the_edge(200, 300, {0.99 * extent, 0.1, 0.1}, false));
  EXPECT_TRUE(reaches_the_edge(200, 300, {0.1, 1.5 * extent, 0.1}, true));
  EXPECT_FALSE(reaches_the_edge(200, 300, {0.1, 1.485 * extent, 0.1}, true));
}

TEST(Renderer, MixesATranslucentShapeWithWhatIsBehindIt) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, -3}), {0.0f, 1.0f, 0.0f, 0.5f});
  renderer->add(shape_at(Box{{5, 5, 1}}, {0, 0, -6}), red);
  const Frame frame = renderer->draw(camera_of(1, 1, 0.1), at_origin);
  const auto [r, g, b] = pixel(frame.color, 0, 0);
  EXPECT_GT(r, 50);
  EXPECT_GT(g, 50);
  EXPECT_EQ(b, 0);
  EXPECT_NEAR(frame.depth.meters[0], 2.5, 0.0035) << "depth is that of the nearest surface, solid or not";
}

TEST(Renderer, MixesTranslucentShapesTheFarthestFirst) {
  std::array<std::array<int, 3>, 2> seen;
  for (const bool near_first : {true, false}) {
    const auto renderer = make_renderer();
    const Shape near = shape_at(Sphere{0.5}, {0, 0, -3});
    const Shape far = shape_at(Box{{1, 1, 1}}, {0, 0, -6});
    renderer->add(near_first ? near : far, near_first ? Color(1, 0, 0, 0.7f) : Color(0, 0, 1, 0.7f));
    renderer->add(near_first ? far : near, near_first ? Color(0, 0, 1, 0.7f) : Color(1, 0, 0, 0.7f));
    seen[near_first] = pixel(renderer->draw(camera_of(1, 1, 0.1), at_origin).color, 0, 0);
  }
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_GT(seen[0][0], seen[0][2]) << "the red one is nearer";
}

TEST(Renderer, LeavesOutAShapeOfNoOpacity) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, -3}), {1.0f, 0.0f, 0.0f, 0.0f});
  renderer->add(shape_at(Box{{5, 5, 1}}, {0, 0, -6}), blue);
  const Frame frame = renderer->draw(camera_of(1, 1, 0.1), at_origin);
  EXPECT_EQ(hue(pixel(frame.color, 0, 0)), Hue::bluish);
  EXPECT_NEAR(frame.depth.meters[0], 5.5, 0.0065);
}

TEST(Renderer, LetsNothingOfAPictureReachTheNext) {
  const auto renderer = make_scene();
  const Frame first = renderer->draw(camera_of(160, 120), scene_view);
  renderer->draw(camera_of(33, 77, 2.0), look_at({0, 0, 5}, {0, 0, 0}));
  Camera without_depth = camera_of(160, 120);
  without_depth.depth = false;
  renderer->draw(without_depth, look_at({1, 1, 1}, {0, 0, 0}));
  expect_same(renderer->draw(camera_of(160, 120), scene_view), first);
}

TEST(Renderer, DrawsTheSameInAnotherRendererAndBesideIt) {
  const auto one = make_scene();
  const Frame first = one->draw(camera_of(160, 120), scene_view);
  const auto other = make_scene();
  expect_same(other->draw(camera_of(160, 120), scene_view), first);
  expect_same(one->draw(camera_of(160, 120), scene_view), first);
}

TEST(Renderer, DrawsAfterAnotherRendererIsGone) {
  const auto one = make_scene();
  const Frame first = one->draw(camera_of(160, 120), scene_view);
  make_scene()->draw(camera_of(50, 50), scene_view);
  expect_same(one->draw(camera_of(160, 120), scene_view), first);
}

TEST(Renderer, DrawsTheSameColoursWithAndWithoutDepth) {
  const auto renderer = make_scene();
  Camera camera = camera_of(160, 120);
  const Image with = renderer->draw(camera, scene_view).color;
  camera.depth = false;
  EXPECT_TRUE(renderer->draw(camera, scene_view).color.pixels == with.pixels);
}

TEST(Renderer, MovesWithTheCameraOnly) {
  const auto renderer = make_renderer();
  const int number = renderer->add(shape_at(Sphere{0.3}, {0, 0, 0}), red);
  const Frame near_origin = renderer->draw(camera_of(64, 48), look_at({2, 0, 0}, {0, 0, 0}));
  Eigen::Isometry3d far_away = Eigen::Isometry3d::Identity();
  far_away.translation() = Eigen::Vector3d(4096, -8192, 512);
  renderer->set_link_pose(number, far_away);
  const Eigen::Isometry3d view = far_away * look_at({2, 0, 0}, {0, 0, 0});
  EXPECT_TRUE(renderer->draw(camera_of(64, 48), view).color.pixels == near_origin.color.pixels);
}

class RendererSizes : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(RendererSizes, AreDrawnWhole) {
  const auto [width, height] = GetParam();
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{1000, 1000, 1}}, {0, 0, -3.5}), red);
  const Frame frame = renderer->draw(camera_of(width, height, 0.01), at_origin);
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  ASSERT_EQ(frame.color.pixels.size(), count * 3);
  ASSERT_EQ(frame.depth.meters.size(), count);
  for (const auto& [x, y] : {std::pair(0, 0), {width - 1, 0}, {0, height - 1}, {width - 1, height - 1}}) {
    EXPECT_EQ(hue(pixel(frame.color, x, y)), Hue::reddish);
    EXPECT_NEAR(meters(frame.depth, x, y), 3.0, 0.004);
  }
}

INSTANTIATE_TEST_SUITE_P(FromOnePixelToTheLargest, RendererSizes,
                         testing::Values(std::pair(1, 1), std::pair(3, 5), std::pair(20, 8000), std::pair(8192, 2),
                                         std::pair(1921, 1079)),
                         [](const auto& instance) {
                           return std::to_string(instance.param.first) + "x" + std::to_string(instance.param.second);
                         });

TEST(Renderer, LeavesTheFloatingPointModesAlone) {
  const auto renderer = make_scene();
  constexpr unsigned modes = ~0x3fu;  // all but the flags of what happened
  const unsigned before = _mm_getcsr() & modes;
  renderer->draw(camera_of(160, 120), scene_view);
  EXPECT_EQ(_mm_getcsr() & modes, before);
}

TEST(Renderer, NamesWhatItsPixelsDependOn) {
  const std::string description = make_renderer()->description();
  EXPECT_EQ(description.rfind("OSMesa, Mesa ", 0), 0u) << description;
  EXPECT_NE(description.find("pipe"), std::string::npos) << description;
}

TEST(RendererDeathTest, RefusesImpossibleCamerasAndShapes) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(make_renderer()->draw(camera_of(0, 5), at_origin), "width is 1 to 8192");
  EXPECT_DEATH(make_renderer()->draw(camera_of(5, 8193), at_origin), "height is 1 to 8192");
  EXPECT_DEATH(make_renderer()->draw(camera_of(5, 5, 3.2), at_origin), "field of view");
  EXPECT_DEATH(make_renderer()->set_link_pose(0, at_origin), "a shape with this number was added");
}

TEST(LookAt, LooksAlongMinusZWithTheWorldsZUp) {
  const Eigen::Isometry3d pose = look_at({1, 2, 3}, {4, 2, 3});
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE((-pose.linear().col(2)).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(pose.linear().col(1).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(pose.linear().determinant(), 1.0, 1e-12);
}

TEST(LookAt, TakesYForUpWhenItLooksStraightDown) {
  const Eigen::Isometry3d pose = look_at({0, 0, 3}, {0, 0, 0});
  EXPECT_TRUE(pose.linear().isIdentity());
}

}  // namespace
}  // namespace rehearse
