// Lights in pictures: where they shine, how strongly, and that they don't change other pixels.

#include <rehearse/renderer.h>

#include <gtest/gtest.h>

#include <cmath>

namespace rehearse {
namespace {

constexpr int side = 61;                // of the pictures, odd: there is a pixel in the middle [pixels]
constexpr double camera_height = 2.0;   // of the camera above the floor [m]
constexpr float albedo = 0.5f;          // of the floor
constexpr double one_step = 1.0 / 255;  // of a colour

Eigen::Isometry3d at(double x, double y, double z) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

Light lamp(float intensity = 0.5f) {
  Light light;
  light.intensity = intensity;
  light.constant = 1.0f;
  light.linear = light.quadratic = 0.0f;
  light.range = unlimited;
  return light;
}

Light spot(float beam_width, float cut_off, float intensity = 0.5f) {
  Light light = lamp(intensity);
  light.cone.emplace();
  light.cone->beam_width = beam_width;
  light.cone->cut_off_angle = cut_off;
  return light;
}

/// A grey floor, seen from above; lights shine down from above, too.
class RendererLights : public ::testing::Test {
 protected:
  RendererLights() : renderer_(std::move(*Renderer::create())) {
    const Color grey(albedo, albedo, albedo, 1.0f);
    renderer_->set_link_pose(renderer_->add({"", Box{{20.0, 20.0, 0.2}}, at(0, 0, -0.1), {}, {}}, grey),
                             Eigen::Isometry3d::Identity());
    camera_.width = camera_.height = side;
    camera_.field_of_view = 1.2;
  }

  int add(const Light& light, const Eigen::Isometry3d& pose) {
    const int number = renderer_->add_light(light);
    renderer_->set_light_pose(number, pose);
    return number;
  }

  Image picture(Quality quality = Quality::plain) {
    return renderer_->draw(camera_, at(0, 0, camera_height), quality).color;
  }

  /// The light on the floor `x` metres to the right of the middle, as summed by the shader: the square of the colour
  /// divided by that of the floor.
  static double light_at(const Image& image, double x, int channel = 0) {
    const double pixel = side / 2 + std::round(x / metres_a_pixel());
    const double color = image.pixels[static_cast<std::size_t>((side / 2 * side + pixel) * 3 + channel)] * one_step;
    return color * color / (albedo * albedo);
  }
  static double metres_a_pixel() { return 2.0 * camera_height * std::tan(0.6) / side; }
  /// The middle of the nearest pixel.
  static double pixel_middle(double x) { return std::round(x / metres_a_pixel()) * metres_a_pixel(); }

  /// The light that must be added `x` metres from the point under the lamp, within one step of colour.
  void expect_added(const Image& dark, const Image& lit, double x, double expected) {
    const double before = light_at(dark, x), after = light_at(lit, x);
    const double resolution = 2.0 * std::sqrt(after) * one_step / albedo;
    EXPECT_NEAR(after - before, expected, 1.2 * resolution) << "at " << x;
  }

  Camera camera_;
  std::unique_ptr<Renderer> renderer_;
};

TEST_F(RendererLights, AddTheirStrengthTimesTheCosine) {
  const Image dark = picture();
  add(lamp(0.5f), at(0, 0, 1.0));
  const Image lit = picture();
  for (const double x : {0.0, 0.3, -0.5, 1.0})
    expect_added(dark, lit, x, 0.5 / std::sqrt(1.0 + pixel_middle(x) * pixel_middle(x)));
}

TEST_F(RendererLights, FadeWithTheDistance) {
  const Image dark = picture();
  Light light = lamp(2.0f);
  light.constant = 0.5f;
  light.linear = 0.25f;
  light.quadratic = 1.5f;
  add(light, at(0, 0, 1.5));
  const Image lit = picture();
  for (const double x : {0.0, 0.5, 1.2}) {
    const double distance = std::hypot(1.5, pixel_middle(x));
    const double fading = 0.5 + 0.25 * distance + 1.5 * distance * distance;
    expect_added(dark, lit, x, 2.0 / fading * 1.5 / distance);
  }
}

TEST_F(RendererLights, EndAtTheirRange) {
  const Image dark = picture();
  Light light = lamp();
  light.range = 1.2;
  add(light, at(0, 0, 1.0));
  const Image lit = picture();
  expect_added(dark, lit, 0.0, 0.5);  // at 1 m: below nine tenths of the range
  expect_added(dark, lit, 0.7, 0.0);  // at 1.22 m
  EXPECT_EQ(light_at(dark, 0.8), light_at(lit, 0.8));
  const double distance = std::hypot(1.0, pixel_middle(0.55)), t = (distance / 1.2 - 0.9) / 0.1;
  expect_added(dark, lit, 0.55, (1.0 - t * t * (3.0 - 2.0 * t)) * 0.5 / distance);
}

TEST_F(RendererLights, OfASpotFillTheirConeAndFadeTowardsItsEdge) {
  const Image dark = picture();
  add(spot(0.3f, 0.6f), at(0, 0, 1.0));
  const Image lit = picture();
  for (const double x : {0.0, 0.25}) expect_added(dark, lit, x, 0.5 / std::hypot(1.0, pixel_middle(x)));
  for (const double x : {0.7, 1.0, -0.8}) EXPECT_EQ(light_at(dark, x), light_at(lit, x)) << x;
  for (const double x : {0.4, 0.5, -0.45}) {
    const double cosine = 1.0 / std::hypot(1.0, pixel_middle(x));
    const double t = (cosine - std::cos(0.6)) / (std::cos(0.3) - std::cos(0.6));
    expect_added(dark, lit, x, t * t * (3.0 - 2.0 * t) * 0.5 * cosine);
  }
}

TEST_F(RendererLights, OfASpotShineAlongTheirDirection) {
  const Image dark = picture();
  Light light = spot(0.2f, 0.25f);
  light.cone->direction = Eigen::Vector3d(3.0, 0.0, -3.0);  // of any length: 45 degrees to the right
  add(light, at(-0.5, 0, 1.0));
  const Image lit = picture();
  expect_added(dark, lit, 0.5, 0.5 * std::sqrt(0.5));
  EXPECT_EQ(light_at(dark, -0.5), light_at(lit, -0.5));
}

TEST_F(RendererLights, OfASpotWhoseBeamIsWiderThanItsConeFillTheCone) {
  const Image dark = picture();
  add(spot(1.570796f, 0.5f), at(0, 0, 1.0));  // Choreonoid's default: a beam beyond the cut-off
  const Image lit = picture();
  expect_added(dark, lit, 0.4, 0.5 / std::hypot(1.0, pixel_middle(0.4)));
  EXPECT_EQ(light_at(dark, 0.65), light_at(lit, 0.65));
}

TEST_F(RendererLights, HaveAColour) {
  const Image dark = picture();
  Light red = lamp();
  red.color = Eigen::Vector3f(1.0f, 0.5f, 0.0f);
  add(red, at(0, 0, 1.0));
  const Image lit = picture();
  EXPECT_NEAR(light_at(lit, 0.0, 0) - light_at(dark, 0.0, 0), 0.5, 0.03);
  EXPECT_NEAR(light_at(lit, 0.0, 1) - light_at(dark, 0.0, 1), 0.25, 0.03);
  EXPECT_EQ(light_at(lit, 0.0, 2), light_at(dark, 0.0, 2));
}

TEST_F(RendererLights, AddUp) {
  const Image dark = picture();
  add(lamp(0.2f), at(0, 0, 1.0));
  add(lamp(0.3f), at(0, 0, 1.5));
  add(spot(0.5f, 0.6f, 0.4f), at(0, 0, 0.5));
  expect_added(dark, picture(), 0.0, 0.9);
}

TEST_F(RendererLights, ThatAreOffChangeNoPixel) {
  const Image dark = picture(), dark_fine = picture(Quality::fine);
  Light off = lamp(5.0f);
  off.on = false;
  const int number = add(off, at(0, 0, 1.0));
  EXPECT_EQ(picture().pixels, dark.pixels);
  EXPECT_EQ(picture(Quality::fine).pixels, dark_fine.pixels);
  renderer_->set_light(number, lamp(5.0f));
  EXPECT_NE(picture().pixels, dark.pixels);
  renderer_->set_light(number, off);
  EXPECT_EQ(picture().pixels, dark.pixels);
}

TEST_F(RendererLights, ShineFromWhereTheyAre) {
  const Image dark = picture();
  const int number = add(lamp(), at(-0.8, 0, 0.3));
  const Image left = picture();
  renderer_->set_light_pose(number, at(0.8, 0, 0.3));
  const Image right = picture();
  EXPECT_GT(light_at(left, -0.8), light_at(left, 0.8) + 0.2);
  EXPECT_GT(light_at(right, 0.8), light_at(right, -0.8) + 0.2);
  EXPECT_NEAR(light_at(left, -0.8), light_at(right, 0.8), 0.03);
  EXPECT_GE(light_at(right, -0.8), light_at(dark, -0.8));
}

TEST_F(RendererLights, DoNotShineOnWhatTurnsAwayFromThem) {
  const Image dark = picture();
  add(lamp(), at(0, 0, -1.0));  // under the floor
  EXPECT_EQ(picture().pixels, dark.pixels);
}

TEST_F(RendererLights, ShineIntoFinePicturesToo) {
  const Image dark = picture(Quality::fine);
  add(lamp(), at(0, 0, 1.0));
  expect_added(dark, picture(Quality::fine), 0.0, 0.5);
}

TEST_F(RendererLights, LeaveDepthAlone) {
  camera_.depth = true;
  const auto before = renderer_->draw(camera_, at(0, 0, camera_height)).depth.meters;
  add(lamp(), at(0, 0, 1.0));
  EXPECT_EQ(renderer_->draw(camera_, at(0, 0, camera_height)).depth.meters, before);
}

TEST_F(RendererLights, WithImpossibleFiguresStillGiveAPicture) {
  const float infinite = std::numeric_limits<float>::infinity(), nan_value = std::nanf("");
  const int number = add(lamp(), at(0, 0, 0));  // in the very surface
  for (const float odd : {infinite, -infinite, nan_value, -1.0f, 0.0f, 3e38f}) {
    for (int field = 0; field < 8; ++field) {
      Light light = spot(0.3f, 0.6f);
      float* fields[] = {&light.intensity, &light.color[1],         &light.constant,
                         &light.linear,    &light.cone->beam_width, &light.cone->cut_off_angle,
                         &light.color[0],  &light.quadratic};
      *fields[field] = odd;
      if (field == 6) light.cone->direction.setZero();
      renderer_->set_light(number, light);
      const Image once = picture();
      EXPECT_EQ(once.pixels, picture().pixels) << odd << " in field " << field;
      EXPECT_GE(light_at(once, 1.0), 0.3) << odd << " in field " << field;  // never darker than without
    }
  }
}

TEST_F(RendererLights, MayBeAsManyAsThereMayBe) {
  const Image dark = picture();
  for (int i = 0; i < Renderer::max_lights; ++i) add(lamp(0.01f), at(0, 0, 1.0));
  expect_added(dark, picture(), 0.0, 0.01 * Renderer::max_lights);
}

}  // namespace
}  // namespace rehearse
