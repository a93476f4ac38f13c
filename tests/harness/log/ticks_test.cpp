// The times of ticks that are the messages of a topic.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "logs/robot_log/log_ticks.h"

namespace rehearse {
namespace {

constexpr std::int64_t one_ms = 1'000'000;  // [ns]

TEST(LogTicks, AreAGridWithoutATopic) {
  const LogTicks ticks(100, 0.001);
  EXPECT_TRUE(ticks.is_nominal());
  EXPECT_EQ(ticks.time(0), 100);
  EXPECT_EQ(ticks.time(7), 100 + 7 * one_ms);
  EXPECT_EQ(ticks.time(-2), 100 - 2 * one_ms);
  EXPECT_EQ(ticks.nearest(100 + 7 * one_ms - 10), 7);
  EXPECT_EQ(ticks.nearest(0), 0);
  EXPECT_TRUE(ticks.has_message(3));
  EXPECT_FALSE(ticks.is_irregular(3));
}

TEST(LogTicks, AreTheMessagesWhateverTheirJitter) {
  const LogTicks ticks = LogTicks::at_messages({0, 11 * one_ms, 19 * one_ms, 30 * one_ms}, 0, 0.01);
  ASSERT_EQ(ticks.size(), 4);
  EXPECT_EQ(ticks.time(1), 11 * one_ms);
  EXPECT_EQ(ticks.time(2), 19 * one_ms);
  EXPECT_EQ(ticks.time(5), 50 * one_ms) << "after the last message they are a grid";
  EXPECT_EQ(ticks.time(-1), -10 * one_ms);
  EXPECT_EQ(ticks.nearest(14 * one_ms), 1);
  EXPECT_EQ(ticks.nearest(16 * one_ms), 2);
  EXPECT_EQ(ticks.nearest(99 * one_ms), 3);
}

TEST(LogTicks, HaveATickForEachMissingMessage) {
  const LogTicks ticks = LogTicks::at_messages({0, 10 * one_ms, 41 * one_ms, 50 * one_ms}, 0, 0.01);
  ASSERT_EQ(ticks.size(), 6);
  EXPECT_FALSE(ticks.has_message(2));
  EXPECT_FALSE(ticks.has_message(3));
  EXPECT_TRUE(ticks.has_message(4));
  EXPECT_GT(ticks.time(2), 10 * one_ms);
  EXPECT_LT(ticks.time(2), ticks.time(3));
  EXPECT_LT(ticks.time(3), 41 * one_ms);
  EXPECT_EQ(ticks.time(5), 50 * one_ms);
}

TEST(LogTicks, TakeALateMessageForNoMissingOne) {
  const LogTicks ticks = LogTicks::at_messages({0, 10 * one_ms, 28 * one_ms, 30 * one_ms, 40 * one_ms}, 0, 0.01);
  EXPECT_EQ(ticks.size(), 5);
  EXPECT_FALSE(ticks.is_irregular(1));
  EXPECT_TRUE(ticks.is_irregular(2));
  EXPECT_TRUE(ticks.is_irregular(3)) << "it comes early after a late one";
  EXPECT_FALSE(ticks.is_irregular(4));
}

TEST(LogTicks, BeginWithTheFirstMessageFromTheStartOn) {
  const LogTicks ticks = LogTicks::at_messages({0, 10 * one_ms, 20 * one_ms}, 5 * one_ms, 0.01);
  EXPECT_EQ(ticks.size(), 2);
  EXPECT_EQ(ticks.time(0), 10 * one_ms);
  EXPECT_EQ(LogTicks::at_messages({0, 10 * one_ms}, 11 * one_ms, 0.01).size(), 0) << "no message is left";
}

TEST(LogTicks, AreNotMadeForMissingMessagesIfTheControllerIsNotCalledThere) {
  const std::vector<std::int64_t> messages{0, 10 * one_ms, 20 * one_ms, 320 * one_ms, 330 * one_ms, 334 * one_ms};
  const LogTicks held = LogTicks::at_messages(messages, 0, 0.01);
  EXPECT_EQ(held.size(), 35);
  EXPECT_FALSE(held.has_message(3));
  const LogTicks skipped = LogTicks::at_messages(messages, 0, 0.01, 0, true);
  ASSERT_EQ(skipped.size(), 6);
  EXPECT_EQ(skipped.time(3), 320 * one_ms);
  EXPECT_TRUE(skipped.has_message(3));
  EXPECT_FALSE(skipped.is_irregular(3)) << "no message is missing";
  EXPECT_TRUE(skipped.is_irregular(5)) << "it comes too early";
}

TEST(LogTicks, BeginBeforeCommandsWhoseFirstOnesAreMissing) {
  const LogTicks ticks = LogTicks::at_messages({24 * one_ms, 34 * one_ms}, 4 * one_ms, 0.01, -3 * one_ms);
  ASSERT_EQ(ticks.size(), 3) << "the first one is 17 ms after the start";
  EXPECT_FALSE(ticks.has_message(0));
  EXPECT_EQ(ticks.time(0), 11 * one_ms);
  EXPECT_EQ(ticks.time(1), 21 * one_ms);
  EXPECT_TRUE(ticks.has_message(1));
}

TEST(LogTicks, AreAGridAtTheRegularTimesOfMessages) {
  std::vector<std::int64_t> messages;
  for (int i = 0; i < 100; ++i)
    if (i % 10 != 7) messages.push_back(std::llround(i * 10.002e6) + (i % 3 - 1) * one_ms);
  messages[50] += 9 * one_ms;
  const RegularTimes times = regular_times(messages, 0.01);
  EXPECT_NEAR(times.period, 10.002e6, 2e3);
  EXPECT_NEAR(static_cast<double>(times.origin), 0.0, 0.1e6);
  EXPECT_NEAR(static_cast<double>(times.jitter), 1e6, 0.2e6);
  const LogTicks ticks =
      LogTicks::at_regular_times({0, 10.002e6, one_ms}, 2 * one_ms, 19 * one_ms, messages.back(), 0.01);
  EXPECT_EQ(ticks.size(), 98);
  EXPECT_EQ(ticks.time(0), 22'004'000) << "of the message that is nearest to the start";
  EXPECT_EQ(ticks.time(97), 2 * one_ms + 99 * 10'002'000);
  EXPECT_FALSE(ticks.is_nominal());
  EXPECT_TRUE(ticks.has_message(5));
  EXPECT_EQ(ticks.nearest(33 * one_ms), 1);
}

TEST(DurationCounts, HaveAMedianOfFiveDigits) {
  DurationCounts counts;
  EXPECT_EQ(counts.median(), 0);
  EXPECT_FALSE(counts.is_regular());
  for (int i = 0; i < 60; ++i) counts.add(2 * one_ms + i * 1000);
  for (int i = 0; i < 5; ++i) counts.add(900 * one_ms);
  EXPECT_EQ(counts.median(), 2 * one_ms + 32'000);
  EXPECT_TRUE(counts.is_regular());
  for (int i = 0; i < 10; ++i) counts.add(20 * one_ms);
  EXPECT_FALSE(counts.is_regular()) << "a joystick that sends when it is moved";
  DurationCounts skewed;  // most a little less than 2 ms, others far more in the same octave
  for (int i = 0; i < 60; ++i) skewed.add(1'999'900);
  for (int i = 0; i < 40; ++i) skewed.add(2'050'000);
  EXPECT_EQ(skewed.median(), 1'999'900);
}

}  // namespace
}  // namespace rehearse
