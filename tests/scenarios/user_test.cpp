// A user's test, to be compiled only: every name of <rehearse/gtest.h> once.
#include <rehearse/gtest.h>

TEST(Walker, StopsBeforeTheEdge) {
  const rehearse::Trace trace = rehearse::record("scenarios/walk_to_edge.yaml");
  EXPECT_LT(trace.last("Walker/BASE/position/x"), 0.95);  // [m], the table ends at 1.00
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Walker, StandsStill) {
  const rehearse::Trace trace = rehearse::record("scenarios/stand.yaml");
  EXPECT_HOLDS(trace);
  ASSERT_HOLDS(trace);
  EXPECT_MATCHES_GOLDEN(trace, rehearse::Exact{});
  EXPECT_MATCHES_GOLDEN(trace, rehearse::Near{"Walker/*/q", 1e-6}, rehearse::Near{"Walker/*/u", 1e-3, 1e-6});
  EXPECT_MATCHES_GOLDEN(trace, rehearse::Until{2.0}, rehearse::Exact{});
  ASSERT_MATCHES_GOLDEN(trace, rehearse::Levels{rehearse::Level::controller, rehearse::Level::plant});
  EXPECT_MATCHES_GOLDEN(rehearse::record("scenarios/stand.yaml"), rehearse::Levels{rehearse::Level::closed});
}

TEST(Walker, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Walker.StopsBeforeTheEdge"); }

TEST(Walker, LeansIntoASlope) {
  rehearse::ControllerBench bench("MyWalker", "models/walker.urdf");
  bench.joint("ANKLE").q = 0.1;  // [rad]
  bench.device("GYRO").values = {0.0, 0.0, 0.1};
  bench.link("BASE").position.z() = 0.7;
  bench.axis("L_STICK_V") = -1.0;
  bench.button("A") = true;
  bench.tick();
  EXPECT_NEAR(bench.joint("ANKLE").u, 12.0, 1e-9);  // [N·m]
}
