// Statistics of a topic's messages relative to the ticks, and values between its messages.
#include <gtest/gtest.h>

#include "logs/robot_log/log_track.h"
#include "logs/robot_log/topic_watch.h"

namespace rehearse {
namespace {

using Age = TopicWatch::Age;

constexpr std::int64_t millisecond = 1'000'000;  // [ns]

LogTopicReport report_of(const TopicWatch& watch, std::int64_t start = 0) {
  LogTopicReport report;
  watch.report(report, start);
  return report;
}

TEST(TopicWatch, CountsWhatTicksSaw) {
  TopicWatch watch(0.1);
  for (const std::int64_t time : {0, 4, 8, 12, 16, 20}) watch.came(time * millisecond);
  EXPECT_EQ(watch.look(0, 0.0, false), Age::fresh);
  EXPECT_EQ(watch.look(10 * millisecond, 0.01, false), Age::fresh);  // sees 8; 4 is skipped
  EXPECT_EQ(watch.look(11 * millisecond, 0.011, false), Age::held);
  EXPECT_EQ(watch.look(20 * millisecond, 0.02, false), Age::fresh);  // 12 and 16 are skipped
  const LogTopicReport report = report_of(watch);
  EXPECT_EQ(report.messages, 6);
  EXPECT_EQ(report.used, 3);
  EXPECT_EQ(report.skipped, 3);
  EXPECT_DOUBLE_EQ(report.rate, 250.0);
  EXPECT_DOUBLE_EQ(report.longest_gap, 0.004);
  EXPECT_DOUBLE_EQ(report.worst_age, 0.003);
  EXPECT_DOUBLE_EQ(report.worst_age_at, 0.011);
  EXPECT_EQ(report.gaps, 0);
}

TEST(TopicWatch, CountsBothSidesOfWhatIsInterpolated) {
  TopicWatch watch(0.1);
  for (const std::int64_t time : {0, 10, 20}) watch.came(time * millisecond);
  watch.look(4 * millisecond, 0.004, true);
  EXPECT_EQ(report_of(watch).used, 2);
  watch.look(14 * millisecond, 0.014, true);
  EXPECT_EQ(report_of(watch).used, 3) << "the one that was behind is before now, and counts once";
}

TEST(TopicWatch, TellsEachGapAndItsTicks) {
  TopicWatch watch(0.01);
  EXPECT_EQ(watch.look(0, 0.0, false), Age::none_yet);
  watch.came(5 * millisecond);
  EXPECT_EQ(watch.look(10 * millisecond, 0.01, false), Age::fresh);
  EXPECT_EQ(watch.look(15 * millisecond, 0.015, false), Age::held) << "just as old as it may be";
  EXPECT_EQ(watch.look(20 * millisecond, 0.02, false), Age::gap_begins);
  EXPECT_EQ(watch.look(30 * millisecond, 0.03, false), Age::gap);
  watch.came(35 * millisecond);
  EXPECT_EQ(watch.look(40 * millisecond, 0.04, false), Age::fresh);
  EXPECT_EQ(watch.look(50 * millisecond, 0.05, false), Age::gap_begins);
  const LogTopicReport report = report_of(watch, 10 * millisecond);
  EXPECT_EQ(report.gaps, 2);
  EXPECT_EQ(report.ticks_in_gaps, 3);
  EXPECT_EQ(report.ticks_without, 1);
  EXPECT_DOUBLE_EQ(report.longest_gap, 0.03);
  EXPECT_DOUBLE_EQ(report.longest_gap_at, -0.005) << "from the first tick on";
  EXPECT_DOUBLE_EQ(report.worst_age, 0.025);
}

TEST(TopicWatch, LeavesOutWhatGoesBackInTime) {
  TopicWatch watch(std::nullopt);
  EXPECT_TRUE(watch.came(10));
  EXPECT_TRUE(watch.came(20));
  EXPECT_FALSE(watch.came(15));
  EXPECT_TRUE(watch.came(20));
  watch.look(1'000'000'000'000, 1000.0, false);
  const LogTopicReport report = report_of(watch);
  EXPECT_EQ(report.messages, 4);
  EXPECT_EQ(report.backwards, 1);
  EXPECT_EQ(report.same_stamp, 1);
  EXPECT_EQ(report.used, 1);
  EXPECT_EQ(report.skipped, 2);
  EXPECT_EQ(report.gaps, 0) << "nothing is too old";
}

TEST(TopicWatch, KnowsWhereAMessageMayBeMissing) {
  TopicWatch watch(std::nullopt, 10 * millisecond);
  for (const std::int64_t time : {0, 11, 30, 40}) watch.came(time * millisecond);
  const auto may_miss = [&watch](std::int64_t time) {
    watch.look(time * millisecond, 0.0, false);
    return watch.may_miss();
  };
  EXPECT_FALSE(may_miss(9)) << "the next one comes in time";
  EXPECT_FALSE(may_miss(12));
  EXPECT_TRUE(may_miss(20)) << "one is missing between 11 and 30";
  EXPECT_FALSE(may_miss(31));
  EXPECT_TRUE(may_miss(50)) << "there is no next one";
  TopicWatch irregular(std::nullopt);
  irregular.came(0);
  irregular.look(1'000 * millisecond, 1.0, false);
  EXPECT_FALSE(irregular.may_miss());
}

TEST(LogTrack, HoldsTheLatestAtOrBeforeATick) {
  LogTrack<1> track;
  EXPECT_FALSE(track.at(5, false));
  track.add(10, {1.0});
  EXPECT_FALSE(track.at(9, false));
  EXPECT_EQ(track.at(10, false)->before->values[0], 1.0);
  track.add(20, {2.0});
  track.add(20, {3.0});
  EXPECT_EQ(track.at(19, false)->before->values[0], 1.0);
  EXPECT_EQ(track.at(19, false)->after, nullptr);
  EXPECT_EQ(track.at(20, false)->before->values[0], 3.0) << "of two at one time the later one";
  EXPECT_EQ(track.at(1000, false)->before->values[0], 3.0);
}

TEST(LogTrack, KnowsWhatLiesBehindATick) {
  LogTrack<1> track;
  track.add(10, {1.0});
  track.add(20, {2.0});
  const auto between = track.at(13, true);
  ASSERT_TRUE(between && between->after);
  EXPECT_EQ(between->fraction, 0.3);
  EXPECT_EQ(mix(between->before->values[0], between->after->values[0], between->fraction), 1.3);
  EXPECT_EQ(track.at(20, true)->after, nullptr) << "exactly there";
  EXPECT_EQ(track.at(25, true)->after, nullptr) << "nothing lies behind it";
}

}  // namespace
}  // namespace rehearse
