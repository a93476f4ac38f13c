// Pictures for people: they have shadows and smooth edges, and otherwise equal pictures for sensors.
#include "scene.h"

#include <set>

namespace rehearse {
namespace {

const Eigen::Isometry3d from_above = look_at({0, 0, 6}, {0, 0, 0});  // +y is up in the picture, +x is right
const Color floor_color = grey;

/// A floor with a box above its middle.
std::unique_ptr<Renderer> box_above_floor(const Color& box_color, double box_size = 0.6) {
  auto renderer = make_renderer();
  renderer->add(shape_at(Box{{20, 20, 0.2}}, {0, 0, -0.1}), floor_color);
  renderer->add(shape_at(Box{{box_size, box_size, 0.1}}, {0, 0, 1}), box_color);
  return renderer;
}

/// The brightness of the floor `sideways` metres from the point below the box, on the line of the sun's direction over
/// the ground; negative is away from the sun.
int floor_brightness(Renderer& renderer, double sideways, Quality quality) {
  const Eigen::Vector3d place = sideways * Eigen::Vector3d(0.55, 0.45, 0.0).normalized();
  Camera camera = camera_of(3, 3, 0.002);
  camera.near_clip = 5.5;  // below the box
  const Eigen::Isometry3d pose = Eigen::Translation3d(place) * from_above;
  return pixel(renderer.draw(camera, pose, quality).color, 1, 1)[1];
}

// At 1 m above the floor the sun moves a shadow by hypot(0.55, 0.45) = 0.71 m away from itself.
TEST(RendererFine, CastsAShadowAwayFromTheSun) {
  const auto renderer = box_above_floor(red);
  const int lit = floor_brightness(*renderer, 2.0, Quality::fine);
  EXPECT_LT(floor_brightness(*renderer, -0.71, Quality::fine), lit - 20);
  EXPECT_NEAR(floor_brightness(*renderer, 0.71, Quality::fine), lit, 3);
  EXPECT_NEAR(floor_brightness(*renderer, -2.0, Quality::fine), lit, 3);
}

TEST(RendererFine, LeavesPlainPicturesWithoutShadows) {
  const auto renderer = box_above_floor(red);
  const int lit = floor_brightness(*renderer, 2.0, Quality::plain);
  EXPECT_NEAR(floor_brightness(*renderer, -0.71, Quality::plain), lit, 3);
}

TEST(RendererFine, HasShadowsAndSmoothEdgesIndependently) {
  const auto renderer = box_above_floor(red);
  const int lit = floor_brightness(*renderer, 2.0, Quality{true, false});
  EXPECT_LT(floor_brightness(*renderer, -0.71, Quality{true, false}), lit - 20);
  EXPECT_NEAR(floor_brightness(*renderer, -0.71, Quality{false, true}), lit, 3);
}

TEST(RendererFine, CastsNoShadowOfWhatIsTranslucentOrLargerThanSixMetres) {
  const auto glass = box_above_floor({1.0f, 0.0f, 0.0f, 0.5f});
  EXPECT_NEAR(floor_brightness(*glass, -0.71, Quality::fine), floor_brightness(*glass, 2.0, Quality::fine), 3);
  const auto ceiling = box_above_floor(red, 6.0);
  const auto nothing = make_renderer();
  nothing->add(shape_at(Box{{20, 20, 0.2}}, {0, 0, -0.1}), floor_color);
  EXPECT_EQ(floor_brightness(*ceiling, -0.71, Quality::fine), floor_brightness(*nothing, -0.71, Quality::fine));
}

TEST(RendererFine, DoesNotSpeckleWhatTheSunShinesOn) {
  const auto renderer = make_renderer();
  renderer->add(shape_at(Box{{1, 1, 1}}, {0, 0, 0.5}), floor_color);
  const Image top = renderer->draw(camera_of(40, 40, 0.1), from_above, Quality::fine).color;
  std::set<int> shades;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) shades.insert(pixel(top, x, y)[1]);
  }
  EXPECT_LE(*shades.rbegin() - *shades.begin(), 2);
}

TEST(RendererFine, HasSmoothEdges) {
  const auto renderer = make_renderer({Color(0, 0, 0, 1)});
  Shape board = shape_at(Box{{1, 1, 0.01}}, {0, 0, 0});
  board.pose.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  renderer->add(board, green);
  const auto shades = [&](Quality quality) {
    const Image image = renderer->draw(camera_of(60, 60, 0.3), from_above, quality).color;
    std::set<int> seen;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 60; ++x) seen.insert(pixel(image, x, y)[1] / 16);
    }
    return seen.size();
  };
  EXPECT_LE(shades(Quality::plain), 3u);
  EXPECT_GE(shades(Quality::fine), 6u);
}

TEST(RendererFine, MeasuresTheDepthThatAPlainPictureMeasures) {
  const auto renderer = box_above_floor(red);
  const Eigen::Isometry3d pose = look_at({3, 1, 2}, {0, 0, 0.5});
  const DepthImage plain = renderer->draw(camera_of(64, 48), pose).depth;
  const DepthImage fine = renderer->draw(camera_of(64, 48), pose, Quality::fine).depth;
  ASSERT_EQ(fine.width, 64);
  ASSERT_EQ(fine.height, 48);
  ASSERT_EQ(fine.meters.size(), plain.meters.size());
  for (std::size_t i = 0; i < plain.meters.size(); ++i) {
    if (std::isfinite(plain.meters[i])) {
      EXPECT_NEAR(fine.meters[i], plain.meters[i], 1e-4 * plain.meters[i]) << i;
    } else {
      EXPECT_EQ(fine.meters[i], plain.meters[i]) << i;
    }
  }
}

TEST(RendererFine, LetsNothingReachTheNextPicture) {
  const auto renderer = box_above_floor(red);
  const Image plain = renderer->draw(camera_of(64, 48), from_above).color;
  const Image fine = renderer->draw(camera_of(64, 48), from_above, Quality::fine).color;
  EXPECT_TRUE(renderer->draw(camera_of(64, 48), from_above).color.pixels == plain.pixels);
  EXPECT_TRUE(renderer->draw(camera_of(64, 48), from_above, Quality::fine).color.pixels == fine.pixels);
}

TEST(RendererFine, DrawsASceneOfNothing) {
  const Image image = make_renderer({Color(0, 0, 1, 1)})->draw(camera_of(5, 4), from_above, Quality::fine).color;
  EXPECT_EQ(pixel(image, 4, 3), (std::array{0, 0, 255}));
}

}  // namespace
}  // namespace rehearse
