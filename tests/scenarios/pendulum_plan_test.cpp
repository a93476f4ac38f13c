// A pendulum that plans swing up and balance, which a thread makes.
#include <rehearse/gtest.h>

#include <cmath>

namespace {

using rehearse::Trace;

const double pi = std::acos(-1.0);
constexpr double degree = 0.017453292519943295;  // [rad]
constexpr double limit = 0.6;                    // of the motor [N·m]

TEST(PendulumPlan, EndsUpright) {
  const Trace trace = rehearse::record("scenarios/pendulum_plan.yaml");
  EXPECT_NEAR(std::remainder(trace.last("Pendulum/HINGE/q") - pi, 2.0 * pi), 0.0, 10.0 * degree);
  EXPECT_LE(trace.max("Pendulum/HINGE/u"), limit);
  EXPECT_GE(trace.min("Pendulum/HINGE/u"), -limit);
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(PendulumPlan, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("PendulumPlan.EndsUpright"); }

TEST(PendulumPlan, HasOneResultInAllOrdersOfItsThreads) { EXPECT_SAME_IN_ALL_ORDERS("PendulumPlan.EndsUpright", 8); }

/// The first case has the scenario's own delay.
TEST(PendulumPlan, FallsWhenItsPlansAreLate) {
  rehearse::SweepCases cases;
  cases.cases = 8;
  const rehearse::SweepResult result = rehearse::sweep("campaigns/pendulum_delay.yaml", cases);
  EXPECT_GT(result.passed, 0) << result.failures;
  EXPECT_LT(result.passed, result.cases) << "some plans are 0.2 s old";
  EXPECT_TRUE(result.repeats);
}

}  // namespace
