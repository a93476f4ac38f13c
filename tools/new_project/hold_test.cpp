#include <rehearse/gtest.h>

constexpr double start = -0.785398;  // [rad]

TEST(Hold, ComesBackAfterAPush) {
  const rehearse::Trace trace = rehearse::record("scenarios/hold.yaml");
  EXPECT_LT(trace.min("Arm/SHOULDER/q"), start - 0.05);  // it was pushed [rad]
  EXPECT_HOLDS(trace);                                   // the scenario's expectations
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Hold, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Hold.ComesBackAfterAPush"); }

TEST(Hold, PullsBackWithTheStiffness) {
  rehearse::ControllerBench bench("Hold", "models/arm.urdf");
  bench.joint("SHOULDER").q = 0.1;  // [rad]; it started at 0
  bench.tick();
  EXPECT_NEAR(bench.joint("SHOULDER").u, -6.0, 1e-12);  // [N·m]
}
