#include <rehearse/gtest.h>

#include <cmath>

TEST(Swing, StaysBelowTheHorizontal) {
  const rehearse::Trace trace = rehearse::record("scenarios/swing.yaml");
  EXPECT_LT(trace.max("Pendulum/HINGE/q"), 1.5707);  // [rad]
  EXPECT_GT(trace.max("Pendulum/HINGE/q"), 0.0);
  EXPECT_EQ(trace.first("Pendulum/Swing/variable/angle seen"), trace.first("Pendulum/HINGE/q"));
  EXPECT_HOLDS(trace);
  EXPECT_MATCHES_GOLDEN(trace, rehearse::Until{2.0}, rehearse::Exact{}, rehearse::Near{"Pendulum/HINGE/u", 1e-9});
}

TEST(Swing, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Swing.StaysBelowTheHorizontal"); }

TEST(Swing, PushesAgainstTheAngle) {
  rehearse::ControllerBench bench("Swing", "models/pendulum.urdf");
  bench.joint("HINGE").q = 0.2;  // [rad]
  bench.tick();
  EXPECT_NEAR(bench.joint("HINGE").u, -0.02, 1e-12);  // [N·m], at time 0
  EXPECT_EQ(bench.variable("angle seen"), 0.2);
}
