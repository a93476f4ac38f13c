// SR1 walks along a pattern from a .seq file, by torque and by velocity.
#include <rehearse/gtest.h>
#include <rehearse/messages.h>

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace {

using rehearse::ControllerBench;
using rehearse::Trace;

// The pattern is that of this build, whatever share folder the user has for other controllers.
const bool has_no_other_share_folder = unsetenv("REHEARSE_CHOREONOID_SHARE") == 0;

rehearse::BenchOptions walking(const std::string& mode) {
  rehearse::BenchOptions options;
  options.options = "{motion: motion/sr1_walk.seq, mode: " + mode + "}";
  return options;
}

void expect_steps(const Trace& trace) {
  for (const std::string foot : {"Left", "Right"}) {
    const std::string force = "SR1/" + foot + "AnkleForceSensor/force/z";
    EXPECT_LT(trace.min(force), 0.0) << "each foot is in the air at times";
    EXPECT_GT(trace.max(force), 1000.0) << "and carries nearly all at others";  // [N], of 1283
  }
}

TEST(SR1Walk, WalksByTorque) {
  const Trace trace = rehearse::record("scenarios/sr1_walk.yaml");
  expect_steps(trace);
  EXPECT_MATCHES_GOLDEN(trace);
}

/// Feet that push against each other through the drives: the direct solver leaves no force unsolved, which would be a warning.
TEST(SR1Walk, WalksByVelocity) {
  const Trace trace = rehearse::record("scenarios/sr1_walk_velocity.yaml");
  expect_steps(trace);
  EXPECT_MATCHES_GOLDEN(trace);
  for (const auto& event : trace.events()) EXPECT_EQ(event.severity, "note") << event.text;
}

TEST(SR1Walk, WalksByVelocityUnderTheQuickSolver) {
  const Trace trace = rehearse::record("scenarios/sr1_walk_quick.yaml");
  expect_steps(trace);
  EXPECT_HOLDS(trace);
}

TEST(SR1Walk, RepeatsItsCommandsWithoutPhysics) {
  EXPECT_REPLAYS("SR1Walk.WalksByTorque");
  EXPECT_REPLAYS("SR1Walk.WalksByVelocity");
}

/// Walks of 20 s from starts that differ by last bits, in turns by each mode of the campaign.
void expect_all_upright(const std::string& campaign, int starts) {
  const rehearse::SweepResult result = rehearse::sweep(campaign, {starts, 1});
  EXPECT_EQ(result.passed, starts) << result.verdict << "\n" << result.failures;
  EXPECT_TRUE(result.repeats);
}

// Under a sanitizer, where a walk takes four times as long, only one per mode on the flat floor: a mode is other code, a
// slope other numbers.
#ifdef __SANITIZE_ADDRESS__
TEST(SR1Walk, StandsUprightAfter20SecondsOnAFlatFloor) { expect_all_upright("campaigns/walk.yaml", 3); }
#else
TEST(SR1Walk, StandsUprightAfter20SecondsOnAFlatFloor) { expect_all_upright("campaigns/walk.yaml", 6); }
TEST(SR1Walk, StandsUprightAfter20SecondsOnASlope) { expect_all_upright("campaigns/walk_slope.yaml", 6); }
TEST(SR1Walk, StandsUprightAfter20SecondsAndAPush) { expect_all_upright("campaigns/walk_push.yaml", 4); }
#endif

TEST(SR1Walk, FollowsItsPattern) {
  ControllerBench bench("SR1WalkController", "models/sr1.urdf", walking("torque"));
  bench.tick();
  EXPECT_NEAR(bench.joint("RLEG_KNEE").u, 8000.0 * 0.92711, 1e-6);  // [N·m], towards the first frame
  bench.joint("RLEG_KNEE").dq = 0.1;                                // [rad/s]
  bench.tick();
  EXPECT_NEAR(bench.joint("RLEG_KNEE").u, 8000.0 * 0.92711 - 10.0, 1e-6);

  ControllerBench by_velocity("SR1WalkController", "models/sr1.urdf", walking("velocity"));
  by_velocity.tick();
  EXPECT_NEAR(by_velocity.joint("RLEG_KNEE").dq_target, 50.0 * 0.92711, 1e-9);  // [rad/s]

  ControllerBench by_displacement("SR1WalkController", "models/sr1.urdf", walking("displacement"));
  by_displacement.device("WaistGyro").values = {0.2, 0.4, 0.0};  // [rad/s]
  by_displacement.tick();
  EXPECT_EQ(by_displacement.joint("RLEG_KNEE").q_target, 0.92711);
  EXPECT_EQ(by_displacement.joint("LLEG_ANKLE_P").q_target, -0.49683) << "its ankles don't turn";
}

TEST(SR1Walk, TurnsItsAnklesAgainstTheWaist) {
  ControllerBench bench("SR1WalkController", "models/sr1.urdf", walking("velocity"));
  bench.tick();
  const double pitch = bench.joint("LLEG_ANKLE_P").dq_target;  // [rad/s]
  const double roll = bench.joint("RLEG_ANKLE_R").dq_target;
  bench.device("WaistGyro").values = {0.2, 0.4, 0.0};  // [rad/s]: to the right, and forwards
  bench.tick();                                        // the pattern itself hardly moves yet
  EXPECT_NEAR(bench.joint("LLEG_ANKLE_P").dq_target - pitch, 50.0 * 0.05 * 0.4, 1e-3) << "toes down";
  EXPECT_NEAR(bench.joint("RLEG_ANKLE_R").dq_target - roll, 50.0 * 0.05 * 0.2, 1e-3);
}

TEST(SR1Walk, RefusesAnUnknownModeAndAMissingMotion) {
  EXPECT_THROW(ControllerBench("SR1WalkController", "models/sr1.urdf", walking("position")), std::runtime_error);
  rehearse::BenchOptions options;
  options.options = "{motion: motion/sr1_flies.seq, mode: torque}";
  EXPECT_THROW(ControllerBench("SR1WalkController", "models/sr1.urdf", options), std::runtime_error);
  EXPECT_THROW(ControllerBench("SR1WalkController", "models/quadruped.urdf", walking("torque")), std::runtime_error);
}

}  // namespace
