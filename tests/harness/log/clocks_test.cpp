// The offset of stamps from the log's clock.
#include <gtest/gtest.h>

#include "logs/robot_log/clock_estimate.h"

namespace rehearse {
namespace {

constexpr std::int64_t second = 1'000'000'000;  // [ns]

ClockEstimate estimate(std::int64_t offset, double drift) {
  ClockEstimate clock;
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t stamp = 500 * second + i * second / 100;
    const std::int64_t delay = 1'000'000 + (i * 7919) % 2'000'000;  // 1 to 3 ms
    clock.add(stamp, stamp + offset + std::llround(drift * i * 1e7) + delay);
  }
  return clock;
}

TEST(ClockEstimate, FindsOffsetAndDriftByTheSmallestDelays) {
  for (const double drift : {0.0, 1e-4, -1e-4}) {
    const LogClockReport found = estimate(1'763'640'000 * second, drift).report().at(0);
    EXPECT_NEAR(static_cast<double>(found.offset - 1'763'640'000 * second), 1e6, 2e4) << "the smallest delay is in it";
    EXPECT_NEAR(found.drift, drift, 1e-6);
    EXPECT_EQ(found.reference, 500 * second);
  }
}

TEST(ClockEstimate, TakesClocksForEqualIfAllDelaysArePlausible) {
  const LogClockReport found = estimate(0, 0.0).report().at(0);
  EXPECT_EQ(found.offset, 0);
  EXPECT_EQ(found.drift, 0.0);
  EXPECT_NEAR(found.least_delay, 0.001, 1e-5);
  EXPECT_NE(estimate(-2'000'000, 0.0).report().at(0).offset, 0) << "a message isn't logged before its stamp";
}

TEST(ClockEstimate, NeedsNoMoreThanAMessage) {
  ClockEstimate clock;
  clock.add(5 * second, 100 * second);
  EXPECT_EQ(clock.report().at(0).offset, 95 * second);
  clock.add(6 * second, 100 * second);
  EXPECT_EQ(clock.report().at(0).offset, 94 * second);
}

TEST(ClockEstimate, LeavesOutAFewWrongStamps) {
  for (const std::int64_t ahead : {second / 100, 3600 * second, -second / 100, -3600 * second}) {
    ClockEstimate clock;
    for (int i = 0; i < 5000; ++i) {
      const std::int64_t time = 500 * second + i * std::int64_t{2'000'000};
      const std::int64_t delay = 50'000 + (i * 7919) % 100'000;  // 50 to 150 us
      clock.add(time - 100 * second + (i % 2000 == 1999 ? ahead : 0), time + std::llround(20e-6 * 2e6 * i) + delay);
    }
    ASSERT_EQ(clock.report().size(), 1) << ahead;
    const LogClockReport found = clock.report()[0];
    EXPECT_NEAR(static_cast<double>(found.offset - 100 * second), 5e4, 2e4) << ahead;
    EXPECT_NEAR(found.drift, 20e-6, 2e-6) << ahead;
  }
}

TEST(ClockEstimate, HasALineForEachSideOfAStep) {
  for (const std::int64_t step : {second, -second / 3, second / 50}) {
    ClockEstimate clock;
    for (int i = 0; i < 5000; ++i) {
      const std::int64_t stamp = 400 * second + i * std::int64_t{2'000'000};
      clock.add(stamp, stamp + 100 * second + (i * 7919) % 100'000 + (i < 2000 ? 0 : step));
    }
    const std::vector<LogClockReport> found = clock.report();
    ASSERT_EQ(found.size(), 2) << step;
    EXPECT_NEAR(static_cast<double>(found[0].offset - 100 * second), 0.0, 2e4) << step;
    const double later = static_cast<double>(found[1].offset - 100 * second - step);
    EXPECT_NEAR(later, 0.0, 2e4) << step;
  }
}

}  // namespace
}  // namespace rehearse
