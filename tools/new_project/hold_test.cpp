#include <rehearse/gtest.h>

constexpr double start = -0.785398;  // [rad]

TEST(Hold, ComesBackAfterAPush) {
  const rehearse::Trace trace = rehearse::record("scenarios/hold.yaml");
  EXPECT_LT(trace.min("Arm/SHOULDER/q"), start - 0.05);    // it was pushed
  EXPECT_NEAR(trace.last("Arm/SHOULDER/q"), start, 0.05);  // gravity leaves it a little below [rad]
  EXPECT_NEAR(trace.last("Arm/SHOULDER/dq"), 0.0, 1e-3);   // [rad/s]
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Hold, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Hold.ComesBackAfterAPush"); }

TEST(Hold, PullsBackWithTheStiffness) {
  rehearse::ControllerBench bench("Hold", "models/arm.urdf");
  bench.joint("SHOULDER").q = 0.1;  // [rad]; it started at 0
  bench.tick();
  EXPECT_NEAR(bench.joint("SHOULDER").u, -6.0, 1e-12);  // [N·m]
}
