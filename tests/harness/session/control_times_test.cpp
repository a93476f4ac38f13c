// How long control() takes: the clock's quantiles, and the times of runs and replays.

#include "core/host/call_clock.h"
#include "runs.h"

#include <chrono>
#include <numeric>

namespace rehearse {
namespace {

using std::chrono::nanoseconds;

TEST(TheCallClock, KnowsQuantilesToItsBinsAndTheLongestExactly) {
  CallClock clock;
  for (int i = 1; i <= 1000; ++i) clock.add(i, nanoseconds(1000 * ((i * 617) % 1000 + 1)));  // 1 to 1000 µs, each once
  const ControlTimes times = clock.times("SR1/Walk", 0.002);
  EXPECT_EQ(times.controller, "SR1/Walk");
  EXPECT_EQ(times.period, 0.002);
  EXPECT_EQ(times.calls, 1000);
  EXPECT_GE(times.median, 500e-6);
  EXPECT_LE(times.median, 500e-6 * 1.016);
  EXPECT_GE(times.p999, 999e-6);
  EXPECT_LE(times.p999, 1000e-6);
  EXPECT_DOUBLE_EQ(times.longest, 1000e-6);
  EXPECT_EQ(times.longest_tick * 617 % 1000, 999);
}

TEST(TheCallClock, HoldsEveryTimeInABinThatContainsIt) {
  for (const std::int64_t time : {std::int64_t{0}, std::int64_t{1}, std::int64_t{63}, std::int64_t{64},
                                  std::int64_t{65}, std::int64_t{127}, std::int64_t{128}, std::int64_t{1'000'003},
                                  std::int64_t{3'600'000'000'000}, std::numeric_limits<std::int64_t>::max()}) {
    CallClock clock;
    clock.add(7, nanoseconds(time));
    clock.add(8, nanoseconds(time));
    const ControlTimes times = clock.times("C", 1.0);
    ASSERT_EQ(times.histogram.size(), 1u) << time;
    EXPECT_EQ(times.histogram[0].second, 2) << time;
    const double seconds = static_cast<double>(time) * 1e-9;
    EXPECT_GE(times.histogram[0].first, seconds * (1.0 - 1e-12)) << time;
    EXPECT_LE(times.histogram[0].first, seconds * 1.016) << time;
    EXPECT_DOUBLE_EQ(times.median, seconds) << time;  // no bin is longer than the longest
    EXPECT_EQ(times.longest_tick, 7) << "the first of equal ones";
  }
}

class ControlTimesOfRuns : public RunTest {};

TEST_F(ControlTimesOfRuns, AreThoseOfEachControllerThatTookPart) {
  record_run(rig(behaviour("A", "push 1") + ", " + behaviour("Slow", "busy 7")));
  ASSERT_EQ(summary_.control_times.size(), 2u);
  for (const ControlTimes& times : summary_.control_times) {
    EXPECT_EQ(times.calls, 20);
    EXPECT_EQ(times.period, 0.001);
    EXPECT_GT(times.median, 0.0);
    EXPECT_LE(times.median, times.p999);
    EXPECT_LE(times.p999, times.longest);
    EXPECT_EQ(std::accumulate(times.histogram.begin(), times.histogram.end(), std::int64_t{0},
                              [](std::int64_t sum, const auto& bin) { return sum + bin.second; }),
              20);
  }
  EXPECT_EQ(summary_.control_times[0].controller, "Rig/A");
  const ControlTimes& slow = summary_.control_times[1];
  EXPECT_EQ(slow.controller, "Rig/Slow");
  EXPECT_EQ(slow.longest_tick, 7);
  EXPECT_GT(slow.longest, 100.0 * slow.median);

  const auto replayed = replay_run();
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  ASSERT_EQ(replayed->control_times.size(), 2u);
  EXPECT_EQ(replayed->control_times[1].longest_tick, 7);
  EXPECT_EQ(replayed->control_times[1].calls, 20);
}

TEST_F(ControlTimesOfRuns, AreNoneOfAControllerThatNeverRan) {
  record_run(rig(behaviour("C", "refuse initialize")));
  EXPECT_TRUE(summary_.control_times.empty());
}

}  // namespace
}  // namespace rehearse
