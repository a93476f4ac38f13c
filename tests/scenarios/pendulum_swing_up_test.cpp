// A pendulum that a weak motor swings up and balances.
#include <rehearse/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using rehearse::ControllerBench;
using rehearse::Trace;

const double pi = std::acos(-1.0);
constexpr double degree = 0.017453292519943295;  // [rad]
constexpr double limit = 0.6;                    // of the motor [N·m]
constexpr double weight_torque = 2.20649625;     // m g l: 0.5 kg, 9.80665 m/s², 0.45 m [N·m]
constexpr double inertia = 0.108734933;          // about the hinge [kg·m²]
constexpr double tap = 5.0;                      // when the ball is tapped [s]

/// From the upright [rad].
double lean(double q) { return std::remainder(q - pi, 2.0 * pi); }

TEST(PendulumSwingUp, EndsUpright) {
  const Trace trace = rehearse::record("scenarios/pendulum_swing_up.yaml");
  EXPECT_NEAR(lean(trace.last("Pendulum/HINGE/q")), 0.0, 1.0 * degree);
  EXPECT_NEAR(trace.last("Pendulum/HINGE/dq"), 0.0, 0.01);  // [rad/s]
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(PendulumSwingUp, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("PendulumSwingUp.EndsUpright"); }

TEST(PendulumSwingUp, UsesNoMoreThanItsMotorHas) {
  const Trace trace = rehearse::record("scenarios/pendulum_swing_up.yaml");
  EXPECT_EQ(trace.max("Pendulum/HINGE/u"), limit);
  EXPECT_EQ(trace.min("Pendulum/HINGE/u"), -limit);
  EXPECT_LT(limit, weight_torque);  // so it can't simply lift it
}

TEST(PendulumSwingUp, SwingsToAndFroBeforeItIsUp) {
  const Trace trace = rehearse::record("scenarios/pendulum_swing_up.yaml");
  const std::vector<double> q = trace.values("Pendulum/HINGE/q");
  std::vector<double> heights;  // of the turning points while it hangs [rad]
  for (std::size_t i = 1; i + 1 < q.size() && std::abs(lean(q[i])) > 30.0 * degree; ++i)
    if ((q[i] - q[i - 1]) * (q[i + 1] - q[i]) < 0.0) heights.push_back(std::abs(q[i]));
  ASSERT_GE(heights.size(), 3u);
  EXPECT_TRUE(std::ranges::is_sorted(heights));
}

TEST(PendulumSwingUp, StaysUpWhenTapped) {
  const Trace trace = rehearse::record("scenarios/pendulum_swing_up.yaml");
  EXPECT_NEAR(lean(trace.at("Pendulum/HINGE/q", tap)), 0.0, 1.0 * degree);
  const std::vector<double> times = trace.times("Pendulum/HINGE/q");
  const std::vector<double> q = trace.values("Pendulum/HINGE/q");
  double farthest = 0.0;  // [rad]
  for (std::size_t i = 0; i < q.size(); ++i)
    if (times[i] > tap) farthest = std::max(farthest, std::abs(lean(q[i])));
  EXPECT_GT(farthest, 1.0 * degree);  // it was felt
  EXPECT_LT(farthest, 10.0 * degree);
}

TEST(PendulumSwingUp, BalancesByStateFeedbackWhateverTurnItIsIn) {
  ControllerBench bench("PendulumSwingUpController", "models/inverted_pendulum.urdf");
  for (const double upright : {pi, -pi, 5.0 * pi}) {
    bench.joint("HINGE").q = upright + 0.02;  // [rad]
    bench.joint("HINGE").dq = -0.05;          // [rad/s]
    bench.tick();
    EXPECT_NEAR(bench.joint("HINGE").u, -(weight_torque + 64.0 * inertia) * 0.02 + 16.0 * inertia * 0.05, 1e-6);
  }
}

TEST(PendulumSwingUp, PushesAlongTheMotionWhileEnergyIsMissing) {
  ControllerBench bench("PendulumSwingUpController", "models/inverted_pendulum.urdf");
  for (const double rate : {1.0, -1.0}) {
    bench.joint("HINGE").dq = rate;  // [rad/s], hanging
    bench.tick();
    EXPECT_EQ(bench.joint("HINGE").u, std::copysign(limit, rate));
  }
}

}  // namespace
