// The ranges of a log's commands, which give default tolerances, and the order of its messages.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "logs/robot_log/command_ranges.h"
#include "logs/robot_log/log_memory.h"
#include "logs/robot_log/order_watch.h"

namespace rehearse {
namespace {

CommandRanges ranges_of(int count, double (*command)(int)) {
  CommandRanges ranges;
  for (int i = 0; i < count; ++i)
    if (ranges.takes_next()) ranges.add({{std::nullopt, std::nullopt, command(i)}});
  return ranges;
}

TEST(CommandRanges, GiveATenThousandthAsTolerance) {
  const auto sine = [](int i) { return 0.003 * std::sin(0.01 * i); };
  for (const int count : {700, 100'000}) {
    const CommandRanges ranges = ranges_of(count, sine);
    EXPECT_NEAR(ranges.range(0, &CommandedJoint::u), 0.006, 1e-5) << count;
    EXPECT_NEAR(ranges.tolerance(0, &CommandedJoint::u, "N·m"), 1e-6, 1e-12) << "a thousandth of the unit's default";
    EXPECT_NEAR(ranges.tolerance(0, &CommandedJoint::u, "rad"), 6e-7, 1e-9) << count;
  }
}

TEST(CommandRanges, LeaveOutRareNumbersAndThoseThatAreNotFinite) {
  const CommandRanges ranges = ranges_of(5000, [](int i) {
    if (i % 500 == 0) return 1e9;
    if (i % 7 == 0) return std::numeric_limits<double>::quiet_NaN();
    return i % 100 < 50 ? 2.0 : 3.0;
  });
  EXPECT_EQ(ranges.range(0, &CommandedJoint::u), 1.0);
}

TEST(CommandRanges, AllowForSinglePrecisionOfAConstant) {
  const CommandRanges ranges = ranges_of(50, [](int) { return 12.3; });
  EXPECT_EQ(ranges.range(0, &CommandedJoint::u), 0.0);
  EXPECT_GT(ranges.tolerance(0, &CommandedJoint::u, "rad"), std::abs(static_cast<double>(12.3F) - 12.3));
  EXPECT_LT(ranges.tolerance(0, &CommandedJoint::u, "rad"), 1e-4);
}

TEST(CommandRanges, AreZeroWithoutCommands) {
  const CommandRanges none;
  EXPECT_EQ(none.range(0, &CommandedJoint::u), 0.0);
}

constexpr std::int64_t ten_ms = 10'000'000;  // [ns]

/// Messages 10 ms apart; the ticks [10 ms] that are in doubt.
std::string doubts(const std::vector<std::pair<std::int64_t, std::int64_t>>& logged_and_stamp,
                   const std::vector<std::uint64_t>& places = {}) {
  OrderWatch watch(0.01);
  for (std::size_t i = 0; i < logged_and_stamp.size(); ++i) {
    mcap::Message message;
    message.log_time = static_cast<std::uint64_t>(logged_and_stamp[i].first);
    message.location.record = places.empty() ? i : places[i];
    watch.add(message, logged_and_stamp[i].second);
  }
  std::string found;
  for (std::size_t i = 0; i < logged_and_stamp.size(); ++i)
    found += watch.doubts(static_cast<std::int64_t>(i) * ten_ms) ? '1' : '0';
  return found;
}

std::vector<std::pair<std::int64_t, std::int64_t>> regular(int count) {
  std::vector<std::pair<std::int64_t, std::int64_t>> messages;
  for (std::int64_t i = 0; i < count; ++i) messages.emplace_back(ten_ms * i, ten_ms * i - ten_ms / 10);
  return messages;
}

TEST(OrderWatch, DoubtsNothingOfRegularMessages) { EXPECT_EQ(doubts(regular(8)), "00000000"); }

TEST(OrderWatch, DoubtsTheTicksOfALateMessage) {
  auto messages = regular(10);
  messages[5].first += 8 * ten_ms / 10;
  EXPECT_EQ(doubts(messages), "0000111100");
}

TEST(OrderWatch, DoubtsTheTicksOfMessagesInAnotherOrderByStampsOrInTheFile) {
  auto messages = regular(10);
  std::swap(messages[5].second, messages[6].second);
  EXPECT_NE(doubts(messages).find("111"), std::string::npos);
  EXPECT_EQ(doubts(regular(10), {0, 1, 2, 3, 6, 5, 7, 8, 9, 10}), "0000111000");
}

TEST(RestOfLog, NamesTheNumberThatIsOffMostAndWhetherByAConstant) {
  RestOfLog rest;
  EXPECT_FALSE(rest.report({}));
  for (int i = 0; i < 30; ++i) rest.add(1.5 + 0.01 * i, {0.1, 0.8 + 0.001 * i});
  const auto found = rest.report({{"PAN/u", "N·m", 1.0}, {"TILT/u", "N·m", 100.0}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->series, "PAN/u");
  EXPECT_EQ(found->from, 1.5);
  EXPECT_EQ(found->ticks, 30);
  EXPECT_NEAR(found->share(), 0.1, 1e-12);
  EXPECT_TRUE(found->is_constant());
  rest.add(2.0, {-0.1, 0.0});
  EXPECT_FALSE(rest.report({{"PAN/u", "N·m", 1.0}, {"TILT/u", "N·m", 100.0}})->is_constant());
}

std::vector<double> multiples_of(double step, int count) {
  std::vector<double> rising;
  for (int i = 0; i < count; ++i) rising.push_back(step * (i - count / 2));
  return rising;
}

TEST(StepOfCommands, IsThatOfRoundedNumbersAlone) {
  EXPECT_NEAR(step_of(multiples_of(0.01, 6)), 0.01, 1e-9);
  EXPECT_NEAR(step_of(multiples_of(60.0 / 32767.0, 500)), 60.0 / 32767.0, 1e-9);
  EXPECT_EQ(step_of(multiples_of(60.0 / 32767.0, 20)), 0.0) << "a controller may have a few levels";
  EXPECT_EQ(step_of(multiples_of(5.0, 3)), 0.0) << "as one that switches on and off";
  std::vector<double> smooth;
  for (int i = 0; i < 500; ++i) smooth.push_back(std::sin(0.003 * i));
  EXPECT_EQ(step_of(smooth), 0.0);
}

}  // namespace
}  // namespace rehearse
