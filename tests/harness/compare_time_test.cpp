// Values that may come early or late: lead and lag.
#include "compare_fixture.h"

#include <cmath>
#include <limits>

namespace rehearse {
namespace {

using testing::Compare;
using testing::SmallTrace;

/// Twenty ticks of 1 ms in which a joint moves by 0.1 rad a tick and the base turns by 0.02 rad a tick about z.
class CompareInTime : public Compare {
 protected:
  CompareInTime() {
    lengthen(20);
    for (SmallTrace* trace : {&golden_, &actual_})
      for (std::size_t i = 0; i < 20; ++i) move(*trace, i, static_cast<double>(i));
  }

  /// Sets the values of that time [ticks].
  static void move(SmallTrace& trace, std::size_t tick, double time) {
    trace.ticks[tick].q = 0.1 * time;
    trace.ticks[tick].rotation = {0.0, 0.0, std::sin(0.01 * time), std::cos(0.01 * time)};
  }
  /// Delays the run by that many ticks relative to the golden.
  void delay(double ticks) {
    for (std::size_t i = 0; i < 20; ++i) move(actual_, i, std::max(0.0, static_cast<double>(i) - ticks));
  }
  static ToleranceRule in_time(double lead, double lag, const std::string& channel = "*") {
    ToleranceRule made = rule(channel);
    made.lead = lead;
    made.lag = lag;
    return made;
  }
};

TEST_F(CompareInTime, LetsARunLagByWhatTheRuleSays) {
  delay(2);
  EXPECT_FALSE(compared().within);
  EXPECT_FALSE(compared({in_time(0.0, 0.001)}).within);
  EXPECT_TRUE(compared({in_time(0.0, 0.002)}).within);
  EXPECT_FALSE(compared({in_time(0.002, 0.0)}).within) << "the other way round";
}

TEST_F(CompareInTime, LetsARunLeadByWhatTheRuleSays) {
  delay(-2);
  move(actual_, 19, 19);
  move(actual_, 18, 19);
  EXPECT_FALSE(compared({in_time(0.001, 0.0)}).within);
  EXPECT_TRUE(compared({in_time(0.002, 0.0)}).within);
}

TEST_F(CompareInTime, TakesWhatLiesBetweenTwoSamplesForPassedThrough) {
  delay(1.5);
  EXPECT_TRUE(compared({in_time(0.0, 0.002)}).within);
  delay(2.5);
  EXPECT_FALSE(compared({in_time(0.0, 0.002)}).within);
}

TEST_F(CompareInTime, EndsTheSpanWithTheRecord) {
  move(actual_, 0, -1.0);
  EXPECT_EQ(compared({in_time(0.01, 0.01)}).first->tick, 0);
  move(actual_, 0, 0.0);
  move(actual_, 19, 20.0);
  EXPECT_EQ(compared({in_time(0.01, 0.01)}).first->tick, 19);
}

TEST_F(CompareInTime, KeepsTheToleranceWhereNothingMoves) {
  for (SmallTrace* trace : {&golden_, &actual_})
    for (auto& tick : trace->ticks) tick.q = 0.5;
  actual_.ticks[5].q = 0.5 + 1e-8;
  EXPECT_FALSE(compared({in_time(0.01, 0.01)}).within);
  actual_.ticks[5].q = 0.5 + 1e-10;
  EXPECT_TRUE(compared({in_time(0.01, 0.01)}).within);
}

TEST_F(CompareInTime, AddsTheToleranceToTheEnvelope) {
  ToleranceRule both = in_time(0.0, 0.001, "Robot/KNEE/q");
  both.atol = 0.02;
  actual_.ticks[5].q = 0.39;  // 0.4 to 0.5 is the range that it passes through
  EXPECT_TRUE(compared({both}).within);
  actual_.ticks[5].q = 0.37;
  EXPECT_FALSE(compared({both}).within);
}

TEST_F(CompareInTime, SkipsTicksThatTheGoldenHasNot) {
  golden_.ticks.erase(golden_.ticks.begin() + 8);
  actual_.ticks.erase(actual_.ticks.begin() + 8);
  delay(0);
  for (SmallTrace* trace : {&golden_, &actual_})
    for (std::size_t i = 0; i < 19; ++i) move(*trace, i, static_cast<double>(trace->ticks[i].tick));
  move(actual_, 8, 7.5);  // tick 9, two milliseconds after tick 7
  EXPECT_FALSE(compared({in_time(0.0, 0.001)}).within);
  EXPECT_TRUE(compared({in_time(0.0, 0.002)}).within);
}

TEST_F(CompareInTime, TakesNanForNanOfTheSameTickOnly) {
  golden_.ticks[5].q = std::nan("");
  EXPECT_FALSE(compared({in_time(0.01, 0.01)}).within);
  actual_.ticks[5].q = std::nan("");
  EXPECT_TRUE(compared({in_time(0.01, 0.01)}).within);
  actual_.ticks[6].q = std::nan("");
  EXPECT_FALSE(compared({in_time(0.01, 0.01)}).within);
}

TEST_F(CompareInTime, LetsNothingPassForAnInfiniteNeighbour) {
  golden_.ticks[5].q = actual_.ticks[5].q = std::numeric_limits<double>::infinity();
  actual_.ticks[6].q = 1e9;
  EXPECT_FALSE(compared({in_time(0.01, 0.01)}).within);
}

TEST_F(CompareInTime, FollowsAnAngleThatWraps) {
  for (SmallTrace* trace : {&golden_, &actual_})
    for (std::size_t i = 0; i < 20; ++i) trace->ticks[i].wheel = 0.1 * static_cast<double>(i);
  actual_.ticks[6].wheel = 0.5 + 2.0 * M_PI;
  EXPECT_FALSE(compared().within);
  EXPECT_TRUE(compared({in_time(0.0, 0.001)}).within);
}

TEST_F(CompareInTime, MeasuresAnOrientationFromThePathBetweenSamples) {
  move(actual_, 5, 3.5);
  actual_.ticks[5].q = 0.5;
  for (double& part : actual_.ticks[5].rotation) part = -part;  // the same orientation
  EXPECT_TRUE(compared({in_time(0.0, 0.002)}).within);
  actual_.ticks[5].rotation[0] += 1e-6;  // beside the path
  const Comparison comparison = compared({in_time(0.0, 0.002)});
  ASSERT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->element.substr(0, 12), "orientation/");
}

}  // namespace
}  // namespace rehearse
