// A spring in a controller: the effect of the command's delay on a swing.
#include <rehearse/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace {

using rehearse::ControllerBench;
using rehearse::Trace;

constexpr double stiffness = 80.0;                     // [N/m]
constexpr double mass = 2.0;                           // [kg]
constexpr double time_step = 0.005;                    // [s]
constexpr double begun_at = 0.1;                       // [m], where the mass is let go
constexpr double end = 5.0;                            // [s]
const double frequency = std::sqrt(stiffness / mass);  // [rad/s]
const double period = 2.0 * std::acos(-1.0) / frequency;

/// Largest displacement in the last swing [m].
double last_height(const Trace& trace) {
  const std::vector<double> times = trace.times("Rail/SLIDE/q");
  const std::vector<double> q = trace.values("Rail/SLIDE/q");
  double height = 0.0;
  for (std::size_t i = 0; i < q.size(); ++i)
    if (times[i] >= end - period) height = std::max(height, std::abs(q[i]));
  return height;
}

/// When the mass passes the middle outwards, between two ticks by a straight line [s].
std::vector<double> passages(const Trace& trace) {
  const std::vector<double> times = trace.times("Rail/SLIDE/q");
  const std::vector<double> q = trace.values("Rail/SLIDE/q");
  std::vector<double> passed;
  for (std::size_t i = 1; i < q.size(); ++i)
    if (q[i - 1] < 0.0 && q[i] >= 0.0) passed.push_back(times[i] - time_step * q[i] / (q[i] - q[i - 1]));
  return passed;
}

TEST(Spring, SwingsWithItsNaturalFrequency) {
  const Trace trace = rehearse::record("scenarios/spring.yaml");
  const std::vector<double> passed = passages(trace);
  ASSERT_EQ(passed.size(), 5u);
  EXPECT_NEAR((passed.back() - passed.front()) / 4.0, period, 0.001 * period);
  EXPECT_MATCHES_GOLDEN(trace);
}

TEST(Spring, RepeatsItsCommandsWithoutPhysics) { EXPECT_REPLAYS("Spring.SwingsWithItsNaturalFrequency"); }

TEST(Spring, KeepsTheHeightOfItsSwing) {
  EXPECT_NEAR(last_height(rehearse::record("scenarios/spring.yaml")), begun_at, 0.01 * begun_at);
}

TEST(Spring, GainsHeightIfItsForceActsOneStepLate) {
  // x'' = -w² x(t - dt) is solved by exp(s t) with s² = -w² exp(-s dt): about x'' = -w² x + w² dt x', an oscillator
  // whose damping is negative, so that its height grows as exp(w² dt t / 2).
  const double grown = std::exp(0.5 * frequency * frequency * time_step * (end - period / 2.0));
  EXPECT_NEAR(last_height(rehearse::record("scenarios/spring_late.yaml")), grown * begun_at, 0.05 * grown * begun_at);
}

TEST(Spring, PullsBackByItsStiffness) {
  rehearse::BenchOptions options;
  options.options = "{stiffness: 80}";
  ControllerBench bench("SpringController", "models/spring_mass.urdf", options);
  bench.joint("SLIDE").q = 0.02;  // [m]
  bench.tick();
  EXPECT_NEAR(bench.joint("SLIDE").u, -stiffness * 0.02, 1e-12);  // [N]
}

TEST(Spring, RefusesToWorkWithoutAStiffness) {
  EXPECT_THROW(ControllerBench("SpringController", "models/spring_mass.urdf"), std::runtime_error);
}

}  // namespace
