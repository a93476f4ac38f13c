// Comparison of events: sequences that begin and end, and their tolerances.
#include "compare_fixture.h"

#include <algorithm>

namespace rehearse {
namespace {

using testing::Compare;
using ::testing::HasSubstr;
using testing::SmallTrace;

msg::Event event(std::int64_t tick, std::string text) {
  return {msg::Time::from_ns(static_cast<std::uint64_t>(tick) * 1'000'000), tick, "warning", "Robot/Pd",
          std::move(text)};
}

/// Ten ticks; contacts of the robot's foot with the floor, and of its hand with a ball.
class CompareEvents : public Compare {
 protected:
  CompareEvents() {
    lengthen(10);
    golden_.contact_changes = actual_.contact_changes = std::vector<msg::ContactChange>();
  }

  static msg::ContactChange change(std::int64_t tick, bool begins, const std::string& link = "Robot/FOOT",
                                   const std::string& other = "Floor/Floor") {
    return {msg::Time::from_ns(static_cast<std::uint64_t>(tick) * 1'000'000), tick, link, other, begins};
  }
  void golden(const std::vector<std::int64_t>& ticks) { fill(golden_, ticks); }
  void actual(const std::vector<std::int64_t>& ticks) { fill(actual_, ticks); }
  static ToleranceRule within_ticks(const std::string& channel, int ticks) {
    ToleranceRule made = rule(channel);
    made.ticks = ticks;
    return made;
  }

 private:
  /// Begin and end in turns.
  static void fill(SmallTrace& trace, const std::vector<std::int64_t>& ticks) {
    trace.contact_changes->clear();
    for (std::size_t i = 0; i < ticks.size(); ++i) trace.contact_changes->push_back(change(ticks[i], i % 2 == 0));
  }
};

TEST_F(CompareEvents, FindsTheSameContactsEqual) {
  golden({1, 5, 7});
  actual({1, 5, 7});
  EXPECT_TRUE(compared().equal);
}

TEST_F(CompareEvents, LetsAContactBeginOneTickLateAndSaysThatBitsDiffer) {
  golden({1, 5});
  actual({2, 5});
  const Comparison comparison = compared();
  EXPECT_TRUE(comparison.within);
  EXPECT_FALSE(comparison.equal);
  EXPECT_EQ(comparison.first_bit->channel, "/contacts");
  EXPECT_EQ(comparison.first_bit->element, "Robot/FOOT Floor/Floor");
}

TEST_F(CompareEvents, CallsAContactTwoTicksLateAFindingWithBothTicks) {
  golden({1, 5});
  actual({1, 7});
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->tick, 5);
  EXPECT_EQ(comparison.first->stage, Stage::physics);
  EXPECT_EQ(comparison.first->note, "the contact ends at tick 7, expected tick 5");
  ASSERT_EQ(comparison.event_differences.size(), 1u);
  EXPECT_EQ(comparison.event_differences[0].event, "contacts/Robot/FOOT/Floor/Floor");
  EXPECT_EQ(comparison.event_differences[0].expected, 5);
  EXPECT_EQ(comparison.event_differences[0].actual, 7);
}

TEST_F(CompareEvents, ComparesSequencesBeforeTimes) {
  golden({1, 3, 5, 7});
  actual({1, 7});  // one contact less, not three that are at other times
  const Comparison comparison = compared();
  EXPECT_EQ(comparison.first->tick, 3);
  EXPECT_EQ(comparison.first->note, "the contact ends at tick 3, which is missing in this run");
  EXPECT_EQ(comparison.beyond, 2);
  ASSERT_EQ(comparison.event_differences.size(), 2u);
  EXPECT_FALSE(comparison.event_differences[0].actual);
}

TEST_F(CompareEvents, CallsAContactThatIsExtraAFinding) {
  golden({1});
  actual({1, 4, 7});
  EXPECT_EQ(compared().first->note, "the contact ends at tick 4, which is not in the golden");
}

TEST_F(CompareEvents, LetsAContactComeAndGoWithinWhatItMayBeOff) {
  golden({1});
  actual({1, 4, 5});
  EXPECT_TRUE(compared().within);
  EXPECT_FALSE(compared({within_ticks("contacts/*", 0)}).within);
}

TEST_F(CompareEvents, LetsAContactBeginAfterTheEndOfWhatIsCompared) {
  golden({9});
  EXPECT_TRUE(compared().within);
  golden({8});
  EXPECT_FALSE(compared().within);
}

TEST_F(CompareEvents, TellsContactsOfOtherLinksApart) {
  golden_.contact_changes = {change(1, true), change(4, true, "Robot/HAND", "Ball/Ball")};
  actual_.contact_changes = {change(1, true, "Robot/HAND", "Ball/Ball"), change(4, true)};  // in another order
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.beyond, 2);
}

TEST_F(CompareEvents, ObeysRulesWithTicks) {
  golden({1, 5});
  actual({1, 8});
  EXPECT_FALSE(compared({within_ticks("contacts/*", 2)}).within);
  EXPECT_TRUE(compared({within_ticks("contacts/*", 3)}).within);
  EXPECT_FALSE(compared({within_ticks("contacts/*/Ball/*", 3)}).within);
  actual({1, 6});
  EXPECT_FALSE(compared({within_ticks("contacts/*", 0)}).within);
}

TEST_F(CompareEvents, DoNotJudgeNumbersOfTheBodiesBesideAnEventThatARuleLetsBeOff) {
  golden({3});
  actual({5});
  for (const std::size_t tick : {3u, 4u, 5u}) actual_.ticks[tick].force = 0.0;
  const Comparison comparison = compared({within_ticks("contacts/*", 2)});
  EXPECT_TRUE(comparison.within);
  EXPECT_EQ(comparison.blanked, 3);
  EXPECT_THAT(verdict(comparison),
              HasSubstr("3 values near events that are early or late within their tolerance were not judged"));
  actual_.ticks[6].force = 0.0;
  EXPECT_EQ(compared({within_ticks("contacts/*", 2)}).first->tick, 6);
}

TEST_F(CompareEvents, JudgeAllNumbersIfNoRuleLetsEventsBeOffOrIfTheyAreNot) {
  golden({3});
  actual({4});
  actual_.ticks[3].force = 0.0;
  EXPECT_FALSE(compared().within);
  actual({3});
  EXPECT_FALSE(compared({within_ticks("contacts/*", 2)}).within);
}

TEST_F(CompareEvents, RemarksOnAGoldenFromBeforeContactsWereRecorded) {
  golden_.contact_changes.reset();
  actual({1});
  actual_.provenance["trace_revision"] = "2";
  const Comparison comparison = compared();
  EXPECT_TRUE(comparison.equal);
  EXPECT_THAT(comparison.remarks[0],
              HasSubstr("the golden was recorded by a version without contacts: /contacts is not compared"));
  golden_.provenance["trace_revision"] = "2";
  EXPECT_FALSE(compared().within) << "it could have recorded them";
}

TEST_F(CompareEvents, FindTheTickInWhichAJointComesToItsEffortLimit) {
  golden_.limits = actual_.limits = {{"limits:KNEE/u", "-100 100"}};
  ToleranceRule loose = rule("Robot/KNEE/u");
  loose.atol = 1e6;
  for (SmallTrace* trace : {&golden_, &actual_})
    for (auto& tick : trace->ticks) tick.applied = tick.tick < 4 ? 50.0 : 100.0;
  EXPECT_TRUE(compared({loose}).equal);
  actual_.ticks[4].applied = 99.9;
  EXPECT_TRUE(compared({loose}).within);
  actual_.ticks[5].applied = 99.9;
  const Comparison comparison = compared({loose});
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->channel, "/Robot/joints");
  EXPECT_EQ(comparison.first->element, "KNEE/u");
  EXPECT_EQ(comparison.first->note, "the stop at the limit begins at tick 6, expected tick 4");
  EXPECT_EQ(comparison.event_differences[0].event, "limits/Robot/KNEE/u");
}

TEST_F(CompareEvents, TakeTheLimitsOfTheRunWhereAnOlderGoldenStatesNone) {
  actual_.limits = {{"limits:KNEE/u", "-100 100"}};
  for (SmallTrace* trace : {&golden_, &actual_})
    for (auto& tick : trace->ticks) tick.applied = 50.0;
  for (const std::size_t tick : {5u, 6u, 7u}) actual_.ticks[tick].applied = -100.0;
  EXPECT_EQ(compared().event_differences.size(), 2u);
}

TEST_F(CompareEvents, LetAJointRestOnItsStopWithoutLeavingIt) {
  golden_.limits = actual_.limits = {{"limits:KNEE/q", "-1 1"}};
  ToleranceRule loose = rule("Robot/KNEE/q");
  loose.atol = 0.01;
  const double resting[] = {0.5, 1.0, 0.9999, 1.0001, 0.9999, 1.0, 0.9999, 1.0, 0.9, 0.5};
  for (std::size_t i = 0; i < 10; ++i) golden_.ticks[i].q = actual_.ticks[i].q = resting[i];
  for (const std::size_t tick : {3u, 5u, 7u}) actual_.ticks[tick].q = 0.9999;
  EXPECT_TRUE(compared({loose}).within);
  EXPECT_TRUE(compared({loose}).event_differences.empty());
}

TEST_F(CompareEvents, TellTheTickInWhichControlReturnsFalse) {
  for (std::size_t tick = 5; tick < 10; ++tick) golden_.ticks[tick].result = false;
  for (std::size_t tick = 6; tick < 10; ++tick) actual_.ticks[tick].result = false;
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->tick, 5);
  EXPECT_EQ(comparison.first->element, "controller_results/0");
  EXPECT_EQ(comparison.first->note, "the result false of control() begins at tick 6, expected tick 5");
  EXPECT_TRUE(compared({within_ticks("controller_results/*", 1)}).within);
}

TEST_F(CompareEvents, TakeNoRefusalFromTheMessageThatClosesARun) {
  golden_.outcome["ticks"] = actual_.outcome["ticks"] = "9";
  golden_.ticks[9].result = false;
  EXPECT_TRUE(compared().equal);
}

TEST_F(CompareEvents, NamesTheFirstEventThatIsNotTheGoldens) {
  golden_.events = {event(0, "hello"), event(1, "saturated")};
  actual_.events = {event(0, "hello"), event(2, "saturated")};
  const Comparison comparison = compared();
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->tick, 1);
  EXPECT_THAT(comparison.first->note, HasSubstr("event 2 is \"tick 2, warning, Robot/Pd: saturated\", expected"));
}

TEST_F(CompareEvents, IsExactAboutWhatControlReturned) {
  actual_.ticks[2].result = false;
  ToleranceRule generous = rule("*");
  generous.atol = 1e6;
  const Comparison comparison = compared({generous});
  EXPECT_FALSE(comparison.within);
  EXPECT_EQ(comparison.first->element, "controller_results/0");
  EXPECT_EQ(comparison.first->stage, Stage::controller);
}

TEST_F(CompareEvents, SayWhetherAMessageIsMissingExtraOrInAnotherOrder) {
  golden_.events = {event(1, "a"), event(2, "b"), event(3, "c")};
  actual_.events = {event(1, "a"), event(3, "c")};
  EXPECT_THAT(compared().first->note,
              HasSubstr("expected \"tick 2, warning, Robot/Pd: b\": the expected one is missing"));
  actual_.events = {event(1, "a"), event(1, "new"), event(2, "b"), event(3, "c")};
  EXPECT_THAT(compared().first->note, HasSubstr("expected \"tick 2, warning, Robot/Pd: b\": it is extra"));
  actual_.events = {event(1, "a"), event(2, "c"), event(3, "b")};
  EXPECT_THAT(compared().first->note, HasSubstr(": the order is different"));
}

TEST_F(CompareEvents, LetAMessageBeOffByWhatARuleSays) {
  golden_.events = {event(1, "a"), event(4, "b")};
  actual_.events = {event(1, "a"), event(6, "b")};
  EXPECT_FALSE(compared().within);
  EXPECT_FALSE(compared({within_ticks("events/*", 1)}).within);
  EXPECT_TRUE(compared({within_ticks("events/*", 2)}).within);
  EXPECT_FALSE(compared({within_ticks("events/*", 2)}).equal);
}

}  // namespace
}  // namespace rehearse
