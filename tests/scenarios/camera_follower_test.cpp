// A pan-tilt head that follows a ball with its camera.
#include <rehearse/gtest.h>
#include <rehearse/urdf.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using rehearse::ControllerBench;
using rehearse::Trace;

constexpr double settled = 0.5;  // when the head has found the ball, and the ball is kicked [s]

const rehearse::Model& head() {
  static const auto model = rehearse::load_urdf(rehearse::fixture_path("models/pan_tilt_head.urdf"));
  return model.value();
}

/// Where the ball's middle would be seen at a time, from the middle of the picture, to the right and down [pixels].
Vector2d ball_in_picture(const Trace& trace, double time) {
  const rehearse::Device& eye = head().devices.at(0);
  const auto& camera = std::get<rehearse::Camera>(eye.kind);
  const std::vector<Eigen::Isometry3d> links = forward_kinematics(
      head(), Eigen::Isometry3d::Identity(), {trace.at("Head/PAN/q", time), trace.at("Head/TILT/q", time)});
  const auto ball = [&](const char* axis) { return trace.at(std::string("Ball/Ball/position/") + axis, time); };
  const Vector3d seen = (links[eye.link] * eye.pose).inverse() * Vector3d(ball("x"), ball("y"), ball("z"));
  const double focal_length = 0.5 * camera.height / std::tan(0.5 * camera.field_of_view);  // [pixels]
  return focal_length / -seen.z() * Vector2d(seen.x(), -seen.y());
}

/// A picture of 64 x 48 pixels with nothing but a red square, whose middle is at x, y.
std::shared_ptr<const rehearse::Image> picture_of_ball(std::size_t x, std::size_t y) {
  constexpr std::size_t width = 64, height = 48;
  auto image = std::make_shared<rehearse::Image>();
  image->width = width;
  image->height = height;
  image->pixels.assign(3 * width * height, 80);
  for (std::size_t row = y - 3; row < y + 3; ++row)
    for (std::size_t column = x - 3; column < x + 3; ++column) {
      unsigned char* pixel = image->pixels.data() + 3 * (width * row + column);
      pixel[0] = 200;
      pixel[1] = pixel[2] = 20;
    }
  return image;
}

TEST(CameraFollower, KeepsTheBallInTheMiddle) {
  const Trace trace = rehearse::record("scenarios/camera_follower.yaml");
  EXPECT_GT(ball_in_picture(trace, 0.0).norm(), 10.0);  // [pixels]: at first it isn't there
  for (double time = settled; time < 4.0; time += 0.02)
    EXPECT_LT(ball_in_picture(trace, time).norm(), 2.5) << "[pixels] at " << time << " s";
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(CameraFollower, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("CameraFollower.KeepsTheBallInTheMiddle"); }

TEST(CameraFollower, TurnsAsFarAsTheBallRolls) {
  const Trace trace = rehearse::record("scenarios/camera_follower.yaml");
  const std::vector<double> y = trace.values("Ball/Ball/position/y");
  const double way = *std::ranges::max_element(y) - *std::ranges::min_element(y);
  EXPECT_GT(way, 0.8);  // [m]
  EXPECT_NEAR(trace.max("Head/PAN/q") - trace.min("Head/PAN/q"),
              std::atan2(trace.max("Ball/Ball/position/y"), 1.2) - std::atan2(trace.min("Ball/Ball/position/y"), 1.2),
              0.05);  // [rad]
}

TEST(CameraFollower, TurnsTowardsTheBall) {
  const auto direction = [](double velocity) { return std::abs(velocity) < 0.1 ? 0.0 : std::copysign(1.0, velocity); };
  struct Case {
    std::size_t x, y;  // of the ball [pixels]
    double pan, tilt;  // directions to turn to: left and down are positive
  };
  for (const Case& at :
       {Case{50, 24, -1.0, 0.0}, Case{14, 24, 1.0, 0.0}, Case{32, 40, 0.0, 1.0}, Case{32, 8, 0.0, -1.0}}) {
    ControllerBench bench("CameraFollowerController", "models/pan_tilt_head.urdf");
    bench.tick();
    bench.device("Eye").image = picture_of_ball(at.x, at.y);
    bench.tick();
    EXPECT_EQ(direction(bench.joint("PAN").dq_target), at.pan) << at.x << ", " << at.y;
    EXPECT_EQ(direction(bench.joint("TILT").dq_target), at.tilt) << at.x << ", " << at.y;
  }
}

TEST(CameraFollower, StandsStillWithoutABall) {
  ControllerBench bench("CameraFollowerController", "models/pan_tilt_head.urdf");
  for (int i = 0; i < 3; ++i) {
    bench.tick();
    EXPECT_EQ(bench.joint("PAN").dq_target, 0.0);
    EXPECT_EQ(bench.joint("TILT").dq_target, 0.0);
  }
}

}  // namespace
