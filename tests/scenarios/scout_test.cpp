// A scout that drives through a room with laser and depth camera.
#include <rehearse/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

namespace {

using rehearse::ControllerBench;
using rehearse::Trace;

constexpr double none = std::numeric_limits<double>::infinity();

TEST(Scout, FindsItsWayThroughARoom) {
  const Trace trace = rehearse::record("scenarios/room.yaml");
  const std::vector<double> x = trace.values("Scout/BASE/position/x"), y = trace.values("Scout/BASE/position/y");
  double nearest_crate = none, nearest_beam = none;
  for (std::size_t i = 0; i < x.size(); ++i) {
    nearest_crate = std::min(nearest_crate, std::hypot(x[i] + 0.2, y[i] + 1.3));
    const double beside = std::max({std::abs(x[i] - 0.4) - 0.075, std::abs(y[i] - 1.2) - 0.8, 0.0});
    nearest_beam = std::min(nearest_beam, beside);
  }
  EXPECT_GT(nearest_crate, 0.35 + 0.2) << "half the crate and half the scout [m]";
  EXPECT_GT(nearest_beam, 0.2) << "which only the camera sees";
  EXPECT_GT(trace.last("Scout/BASE/position/x"), 1.5) << "it is on the other side of the room";
  EXPECT_NEAR(trace.max("Scout/BASE/position/z"), 0.1, 0.002) << "its wheels stay on the floor";
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Scout, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Scout.FindsItsWayThroughARoom"); }

/// The speed and the turning of the scout after two seconds [m/s], [rad/s].
struct Drive {
  double speed, turn;
};

Drive drive_with(const std::vector<double>& ranges, float wall = std::numeric_limits<float>::infinity()) {
  rehearse::BenchOptions options;
  options.time_step = 0.01;
  ControllerBench bench("ScoutController", "models/scout.urdf", options);
  bench.device("Laser").values = ranges;
  const auto depth = std::make_shared<rehearse::DepthImage>();
  depth->width = 64;
  depth->height = 48;
  depth->meters.assign(64 * 48, wall);
  bench.device("Depth").depth = depth;
  const auto image = std::make_shared<rehearse::Image>();
  image->width = 64;
  image->height = 48;
  image->pixels.assign(64 * 48 * 3, 0);
  bench.device("Depth").image = image;
  for (int i = 0; i < 200; ++i) bench.tick();
  const double left = 0.1 * bench.joint("LEFT_WHEEL").dq_target, right = 0.1 * bench.joint("RIGHT_WHEEL").dq_target;
  return {(left + right) / 2.0, (right - left) / 0.32};
}

TEST(Scout, DrivesStraightWhereNothingIs) {
  const Drive drive = drive_with(std::vector<double>(169, none));
  EXPECT_NEAR(drive.speed, 0.5, 1e-9);
  EXPECT_NEAR(drive.turn, 0.0, 1e-9);
}

TEST(Scout, TurnsToWhereThereIsSpace) {
  std::vector<double> ranges(169, 0.6);
  std::fill(ranges.begin() + 110, ranges.end(), 5.0);  // on the left
  EXPECT_GT(drive_with(ranges).turn, 0.5);
  std::ranges::reverse(ranges);
  EXPECT_LT(drive_with(ranges).turn, -0.5);
}

TEST(Scout, StopsBeforeWhatOnlyItsCameraSees) {
  EXPECT_LT(drive_with(std::vector<double>(169, none), 0.3f).speed, 0.05);
}

TEST(Scout, DoesNotMoveBeforeItHasSeenAnything) {
  ControllerBench bench("ScoutController", "models/scout.urdf");
  bench.tick();
  EXPECT_EQ(bench.joint("LEFT_WHEEL").dq_target, 0.0);
}

}  // namespace
