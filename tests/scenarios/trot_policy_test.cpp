// A quadruped that trots by a network.
#include <rehearse/gtest.h>

#include <cmath>

namespace {

using rehearse::Trace;

TEST(TrotPolicy, WalksAhead) {
  const Trace trace = rehearse::record("scenarios/trot_policy.yaml");
  EXPECT_GT(trace.last("Quadruped/TRUNK/position/x"), 0.4);
  EXPECT_GT(trace.min("Quadruped/TRUNK/position/z"), 0.28) << "it never falls";
  EXPECT_LT(std::abs(trace.last("Quadruped/TRUNK/position/y")), 0.2);
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(TrotPolicy, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("TrotPolicy.WalksAhead"); }

}  // namespace
