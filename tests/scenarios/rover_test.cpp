// A rover that stops before an obstacle that its range sensor measures.
#include <rehearse/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace {

using rehearse::ControllerBench;
using rehearse::Trace;

constexpr double wall = 3.0;     // where its face is [m]
constexpr double sensor = 0.22;  // ahead of the rover's middle [m]
constexpr double none = std::numeric_limits<double>::infinity();

TEST(Rover, StopsBeforeTheWall) {
  const Trace trace = rehearse::record("scenarios/rover.yaml");
  EXPECT_NEAR(trace.last("Rover/BASE/position/x"), wall - 0.5 - sensor, 0.05);  // [m]
  EXPECT_NEAR(trace.last("Rover/BASE/linear/x"), 0.0, 0.01);                    // [m/s]
  EXPECT_NEAR(trace.max("Rover/BASE/linear/x"), 1.0, 0.05);                     // it wasn't slowed by the post
  EXPECT_NEAR(trace.last("Rover/BASE/position/y"), 0.0, 0.02);
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Rover, RepeatsItsCommandsWithoutPhysics) { ASSERT_REPLAYS("Rover.StopsBeforeTheWall"); }

/// The rover's wheel speed after a second with this in each beam [m/s].
double speed_with(const std::vector<double>& ranges, const std::string& options = "") {
  rehearse::BenchOptions bench_options;
  bench_options.time_step = 0.01;
  bench_options.options = options;
  ControllerBench bench("RoverController", "models/rover.urdf", bench_options);
  bench.device("Scanner").values = ranges;
  for (int i = 0; i < 100; ++i) bench.tick();
  return 0.1 * bench.joint("WHEEL_FL").dq_target;
}

TEST(Rover, DrivesAtFullSpeedWhereNothingComesBack) {
  EXPECT_NEAR(speed_with(std::vector<double>(41, none)), 1.0, 1e-9);
}

TEST(Rover, DoesNotMoveBeforeItHasSeenAnything) {
  ControllerBench bench("RoverController", "models/rover.urdf");
  bench.tick();
  EXPECT_EQ(bench.joint("WHEEL_FL").dq_target, 0.0);
}

TEST(Rover, BrakesForWhatIsAheadAndNotForWhatIsBeside) {
  std::vector<double> ranges(41, none);
  ranges[20] = 0.5 + 0.1;                                             // straight ahead
  EXPECT_NEAR(speed_with(ranges), std::sqrt(2.0 * 0.8 * 0.1), 1e-6);  // ranges are single precision
  EXPECT_NEAR(speed_with(ranges, "0.7"), 0.0, 1e-9);
  ranges.assign(41, none);
  ranges[40] = 0.6;  // 0.8 rad to the left: 0.43 m beside its way
  EXPECT_NEAR(speed_with(ranges), 1.0, 1e-9);
}

}  // namespace
