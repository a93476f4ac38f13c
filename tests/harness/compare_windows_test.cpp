// Recordings that are compared in windows of time. The fixture compares everything in windows of a tick, of some ticks
// and as a whole; here is what a border of windows may divide.
#include "compare_fixture.h"

namespace rehearse {
namespace {

using testing::SmallTick;

class CompareWindows : public testing::Compare {
 protected:
  CompareWindows() { lengthen(40); }
};

TEST_F(CompareWindows, FindsADifferenceInEachTick) {
  for (std::size_t tick = 0; tick < 40; ++tick) {
    actual_ = golden_;
    actual_.ticks[tick].q += 0.1;
    const Comparison found = compared();
    ASSERT_TRUE(found.first) << tick;
    EXPECT_EQ(found.first->tick, static_cast<std::int64_t>(tick));
    EXPECT_EQ(found.differing, 1) << tick;
  }
}

/// Runs of four seconds, whose first seconds may be equal.
class CompareSeconds : public testing::Compare {
 protected:
  CompareSeconds() {
    lengthen(14);
    for (testing::SmallTrace* run : {&golden_, &actual_})
      for (SmallTick& tick : run->ticks) tick.tick *= 300;
  }
};

TEST_F(CompareSeconds, FindsADifferenceInEachTick) {
  ToleranceRule late = rule("Robot/KNEE/q");
  late.lead = late.lag = 0.7;
  for (const std::vector<ToleranceRule>& rules : {std::vector<ToleranceRule>(), {late}}) {
    for (std::size_t tick = 0; tick < 14; ++tick) {
      actual_ = golden_;
      actual_.ticks[tick].q += 0.1;
      const Comparison found = compared(rules);
      ASSERT_TRUE(found.first) << tick;
      EXPECT_EQ(found.first->tick, static_cast<std::int64_t>(300 * tick));
      EXPECT_EQ(found.differing, 1) << tick;
    }
  }
}

TEST_F(CompareSeconds, FindsAMessageWithoutAClock) {
  for (testing::SmallTrace* run : {&golden_, &actual_}) run->left_out = {"/tick"};
  actual_.ticks[11].q += 0.1;
  const Comparison found = compared();
  ASSERT_TRUE(found.first);
  EXPECT_EQ(found.first->tick, 11) << "the number of the message";
}

TEST_F(CompareSeconds, StopsAtTheHorizon) {
  actual_.ticks[9].q += 0.1;
  CompareOptions early;
  early.until = 2.5;
  EXPECT_TRUE(compared({}, early).within);
  early.until = 2.7;
  EXPECT_FALSE(compared({}, early).within);
}

TEST_F(CompareWindows, KeepsTheFirstAndTheWorstOfSeveral) {
  actual_.ticks[7].q += 0.1;
  actual_.ticks[23].q += 0.3;
  actual_.ticks[31].q += 0.2;
  const Comparison found = compared();
  EXPECT_EQ(found.first->tick, 7);
  EXPECT_EQ(found.worst->tick, 23);
  EXPECT_EQ(found.beyond, 3);
}

TEST_F(CompareWindows, CountsMissingMessagesOverAllWindows) {
  actual_.ticks.erase(actual_.ticks.begin() + 20, actual_.ticks.begin() + 23);
  const Comparison found = compared();
  ASSERT_TRUE(found.first);
  EXPECT_EQ(found.first->tick, 20);
  EXPECT_FALSE(found.within);
}

TEST_F(CompareWindows, ReadsTheScaleOfASeriesThatIsLargestAtItsEnd) {
  ToleranceRule relative = rule("Robot/KNEE/q");
  relative.atol = 0.0;
  relative.rtol = 0.01;
  golden_.ticks[39].q = actual_.ticks[39].q = 100.0;
  actual_.ticks[3].q += 0.9;
  EXPECT_TRUE(compared({relative}).within) << "0.01 of 100";
  golden_.ticks[39].q = actual_.ticks[39].q = 10.0;
  EXPECT_FALSE(compared({relative}).within) << "0.01 of 10";
}

TEST_F(CompareWindows, AllowsForTimeAcrossTheBordersOfWindows) {
  ToleranceRule late = rule("Robot/KNEE/q");
  late.lead = late.lag = 0.002;
  for (std::size_t tick = 0; tick < 40; ++tick) golden_.ticks[tick].q = 0.1 * static_cast<double>(tick);
  for (std::size_t tick = 2; tick < 40; ++tick) actual_.ticks[tick].q = golden_.ticks[tick - 2].q;
  for (std::size_t tick = 0; tick < 2; ++tick) actual_.ticks[tick].q = golden_.ticks[0].q;
  EXPECT_TRUE(compared({late}).within) << "two ticks late";
  late.lag = 0.001;
  EXPECT_FALSE(compared({late}).within) << "two ticks late, and one is allowed";
  std::swap(golden_, actual_);
  late.lag = 0.0;
  EXPECT_FALSE(compared({rule("Robot/KNEE/q")}).within);
}

TEST_F(CompareWindows, KnowsTheColumnsOfASeriesThatBeginsLate) {
  for (testing::SmallTrace* run : {&golden_, &actual_}) {
    run->ticks[30].contacts.emplace(2);
    run->ticks[10].contacts.emplace();
    run->ticks[35].ranges = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  }
  EXPECT_TRUE(compared().equal);
  actual_.ticks[33].ranges[2] = 2.5F;
  actual_.ticks[30].contacts->at(1).depth += 1.0;
  const Comparison found = compared();
  EXPECT_EQ(found.first->tick, 30);
  EXPECT_EQ(found.beyond, 2);
}

TEST_F(CompareWindows, FindsAnEventInEachTick) {
  golden_.contact_changes.emplace();
  for (std::int64_t tick = 3; tick < 40; tick += 6) {
    actual_.contact_changes = golden_.contact_changes;
    msg::ContactChange change;
    change.tick = tick;
    change.stamp = msg::Time::from_ns(static_cast<std::uint64_t>(tick) * 1'000'000);
    change.link = "Robot/FOOT";
    change.other = "Floor/Floor";
    change.begins = true;
    actual_.contact_changes->push_back(change);
    const Comparison found = compared();
    ASSERT_TRUE(found.first_bit) << tick;
    EXPECT_EQ(found.first_bit->tick, tick);
  }
}

}  // namespace
}  // namespace rehearse
