// The offset of stamps from the log's clock.
#include <gtest/gtest.h>

#include "logs/robot_log/log_clocks.h"

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
    const LogClockReport found = estimate(1'763'640'000 * second, drift).report();
    EXPECT_NEAR(static_cast<double>(found.offset - 1'763'640'000 * second), 1e6, 2e4) << "the smallest delay is in it";
    EXPECT_NEAR(found.drift, drift, 1e-6);
    EXPECT_EQ(found.reference, 500 * second);
  }
}

TEST(ClockEstimate, TakesClocksForEqualIfAllDelaysArePlausible) {
  const LogClockReport found = estimate(0, 0.0).report();
  EXPECT_EQ(found.offset, 0);
  EXPECT_EQ(found.drift, 0.0);
  EXPECT_NEAR(found.least_delay, 0.001, 1e-5);
  EXPECT_NE(estimate(-2'000'000, 0.0).report().offset, 0) << "a message isn't logged before its stamp";
}

TEST(ClockEstimate, NeedsNoMoreThanAMessage) {
  ClockEstimate clock;
  clock.add(5 * second, 100 * second);
  EXPECT_EQ(clock.report().offset, 95 * second);
  clock.add(5 * second, 99 * second);
  EXPECT_EQ(clock.report().offset, 94 * second);
}

}  // namespace
}  // namespace rehearse
