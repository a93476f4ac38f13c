// Expectations of a run, evaluated on recordings made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/check.h>

#include <bit>
#include <functional>
#include <limits>

#include "small_traces.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using testing::nan_value;
using testing::SmallTrace;
using testing::TemporaryFolder;

Expectation of(const std::string& series) {
  Expectation expectation;
  expectation.pattern = series;
  return expectation;
}

Expectation of_event(const std::string& pattern, Expectation::Subject subject) {
  Expectation expectation = of(pattern);
  expectation.subject = subject;
  return expectation;
}

/// Five ticks of 1 ms, in which the base sinks from 0.7 m by 0.1 m a tick, and one event.
class Expectations : public ::testing::Test {
 protected:
  Expectations() {
    run_.ticks = {{0}, {1}, {2}, {3}, {4}};
    for (std::size_t i = 0; i < run_.ticks.size(); ++i) run_.ticks[i].position[2] = 0.7 - 0.1 * static_cast<double>(i);
    run_.outcome = {{"ticks", "5"}, {"complete", "true"}};
    run_.events = {{msg::Time::from_ns(2'000'000), 2, "note", "Robot/Pd", "the goal is reached"}};
  }

  /// Evaluated for the whole run; evaluation tick by tick must give the same result.
  ExpectationResult judged(const Expectation& expectation) {
    const Trace trace = run_.load(folder_ / "run.mcap");
    const ExpectationResult result = judge_expectations({expectation}, trace)[0];
    const auto in_pieces = judge_expectations({expectation}, folder_ / "run.mcap", 1);
    EXPECT_TRUE(in_pieces) << to_string(in_pieces.errors());
    expect_same((*in_pieces)[0], result);
    return result;
  }
  static void expect_same(const ExpectationResult& a, const ExpectationResult& b) {
    EXPECT_EQ(a.holds, b.holds);
    EXPECT_EQ(a.text, b.text);
    EXPECT_EQ(a.sentence, b.sentence);
    EXPECT_EQ(a.series, b.series);
    expect_same(a.first, b.first);
    expect_same(a.worst, b.worst);
    EXPECT_EQ(a.margin, b.margin);
  }
  static void expect_same(const std::optional<ViolatingSample>& a, const std::optional<ViolatingSample>& b) {
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) return;
    EXPECT_EQ(a->tick, b->tick);
    EXPECT_EQ(a->time, b->time);
    ASSERT_EQ(a->value.has_value(), b->value.has_value());
    if (a->value) {
      EXPECT_EQ(std::bit_cast<std::uint64_t>(*a->value), std::bit_cast<std::uint64_t>(*b->value));
    }
  }
  std::string sentence(const Expectation& expectation) {
    const ExpectationResult result = judged(expectation);
    EXPECT_EQ(result.holds, result.sentence.empty());
    return result.sentence;
  }

  TemporaryFolder folder_;
  SmallTrace run_;
  const std::string height_ = "Robot/BASE/position/z";
};

TEST_F(Expectations, HoldIfEverySampleIsWithinTheBounds) {
  Expectation stands = of(height_);
  stands.above = 0.25;
  const ExpectationResult result = judged(stands);
  EXPECT_TRUE(result.holds);
  EXPECT_EQ(result.text, "Robot/BASE/position/z above 0.25 m");
  EXPECT_EQ(result.sentence, "");
  EXPECT_FALSE(result.first);
}

TEST_F(Expectations, TellTheFirstAndTheWorstSampleThatViolates) {
  Expectation stands = of(height_);
  stands.above = 0.55;
  const ExpectationResult result = judged(stands);
  EXPECT_FALSE(result.holds);
  EXPECT_EQ(
      result.sentence,
      "expected Robot/BASE/position/z above 0.55 m: 0.5 m at tick 2 (0.002 s), at worst 0.3 m at tick 4 (0.004 s)");
  EXPECT_EQ(result.series, height_);
  ASSERT_TRUE(result.first && result.worst);
  EXPECT_EQ(result.first->tick, 2);
  EXPECT_EQ(result.first->time, 0.002);
  EXPECT_NEAR(*result.first->value, 0.5, 1e-12);
  EXPECT_EQ(result.worst->tick, 4);
}

TEST_F(Expectations, HaveAMarginToTheirViolation) {
  const auto margin = [&](const std::function<void(Expectation&)>& set) {
    Expectation expectation = of(height_);
    set(expectation);
    return judged(expectation).margin.value_or(1e9);
  };
  EXPECT_NEAR(margin([](Expectation& e) { e.above = 0.25; }), 0.05, 1e-12) << "of the lowest sample, 0.3 m";
  EXPECT_NEAR(margin([](Expectation& e) { e.above = 0.55; }), -0.25, 1e-12) << "violated";
  EXPECT_NEAR(margin([](Expectation& e) { e.above = 0.25, e.below = 0.75; }), 0.05, 1e-12) << "of the nearer bound";
  EXPECT_NEAR(margin([](Expectation& e) { e.near = 0.5, e.within = 0.3; }), 0.1, 1e-12);
  EXPECT_NEAR(margin([](Expectation& e) { e.above = 0.55, e.sometime = true; }), 0.15, 1e-12) << "of the best sample";
  EXPECT_NEAR(margin([](Expectation& e) { e.above = 0.35, e.at = 0.001; }), 0.25, 1e-12) << "of that moment alone";
  EXPECT_FALSE(judged(of_event("*goal*", Expectation::Subject::event)).margin);
}

TEST_F(Expectations, CountOnlyTheSpanWithBothItsEnds) {
  Expectation stands = of(height_);
  stands.above = 0.45;
  stands.until = 0.002;
  EXPECT_EQ(sentence(stands), "");
  stands.until = 0.003;
  EXPECT_THAT(sentence(stands), HasSubstr("above 0.45 m until 0.003 s: 0.4 m at tick 3"));
  stands.until = std::nullopt;
  stands.above = std::nullopt;
  stands.below = 0.55;
  stands.from = 0.002;
  EXPECT_EQ(sentence(stands), "");
  stands.from = 0.001;
  EXPECT_THAT(sentence(stands), HasSubstr("below 0.55 m from 0.001 s on: 0.6 m at tick 1"));
}

TEST_F(Expectations, TakeABoundOfAboveAndBelowForWrongAndOfWithinForRight) {
  run_.ticks = {{0}};
  Expectation force = of("Robot/Foot/force/z");  // 650 N
  force.above = 650.0;
  EXPECT_NE(sentence(force), "");
  force.above = std::nullopt;
  force.below = 650.0;
  EXPECT_NE(sentence(force), "");
  force.below = std::nullopt;
  force.near = 640.0;
  force.within = 10.0;
  EXPECT_EQ(sentence(force), "");
}

TEST_F(Expectations, JudgeOneMoment) {
  Expectation goal = of(height_);
  goal.near = 0.4;
  goal.within = 0.05;
  goal.at_end = true;
  EXPECT_EQ(sentence(goal),
            "expected Robot/BASE/position/z within 0.05 m of 0.4 m at the end: 0.3 m at tick 4 (0.004 s)");
  goal.at_end = false;
  goal.at = 0.0035;  // between two ticks the earlier one counts
  EXPECT_EQ(sentence(goal), "");
}

TEST_F(Expectations, BoundAChangeSinceATime) {
  Expectation drift = of(height_);
  drift.since = drift.from = 0.001;
  drift.above = -0.25;
  EXPECT_EQ(sentence(drift),
            "expected the change of Robot/BASE/position/z since 0.001 s above -0.25 m: -0.3 m at tick 4 (0.004 s)");
  drift.above = -0.35;
  EXPECT_EQ(sentence(drift), "");
}

TEST_F(Expectations, BoundAMagnitude) {
  run_.ticks[3].u = -20.0;
  Expectation effort = of("Robot/Pd/output/KNEE/u");
  effort.absolute = true;
  effort.below = 15.0;
  EXPECT_THAT(sentence(effort),
              HasSubstr("the magnitude of Robot/Pd/output/KNEE/u below 15 N·m: 20 N·m at tick 3 (0.003 s)"));
}

TEST_F(Expectations, AreContentWithOneSampleIfToldSo) {
  Expectation lifts = of(height_);
  lifts.sometime = true;
  lifts.below = 0.35;
  EXPECT_EQ(sentence(lifts), "");
  lifts.below = 0.25;
  EXPECT_EQ(
      sentence(lifts),
      "expected Robot/BASE/position/z below 0.25 m at some time: never, the nearest is 0.3 m at tick 4 (0.004 s)");
}

TEST_F(Expectations, AreOfEachSeriesThatMatches) {
  run_.ticks[1].position[1] = -2.0;
  Expectation near_start = of("Robot/BASE/position/*");
  near_start.above = -1.0;
  near_start.below = 5.0;
  EXPECT_EQ(sentence(near_start),
            "expected Robot/BASE/position/* above -1 m and below 5 m: Robot/BASE/position/x is 10 m at tick 0 (0 s); "
            "2 of 3 series violate this");
}

TEST_F(Expectations, TellEachNumberInTheUnitOfItsSeries) {
  Expectation all = of("Robot/*");  // of metres, newtons, radians
  all.below = 300.0;
  EXPECT_THAT(sentence(all), HasSubstr("expected Robot/* below 300: Robot/Foot/force/z is 650 N at tick 0 (0 s)"));
}

TEST_F(Expectations, NameTheNearestSeriesIfThereIsNone) {
  Expectation misspelt = of("Robot/BAS/position/z");
  misspelt.above = 0.0;
  const ExpectationResult result = judged(misspelt);
  EXPECT_FALSE(result.holds);
  EXPECT_FALSE(result.first);
  EXPECT_THAT(result.sentence, HasSubstr("the run has no such series; the nearest are Robot/BASE/position/z, "));
}

TEST_F(Expectations, NameTheSeriesThatAPatternIsMostLike) {
  Expectation misspelt = of("Robot/*/positon/z");
  misspelt.above = 0.0;
  EXPECT_THAT(sentence(misspelt), HasSubstr("the nearest are Robot/BASE/position/z, "));
}

TEST_F(Expectations, AreViolatedByNaN) {
  run_.ticks[2].position[2] = nan_value;
  Expectation stands = of(height_);
  stands.above = 0.0;
  EXPECT_THAT(sentence(stands), HasSubstr("nan m at tick 2"));
  stands.sometime = true;
  EXPECT_EQ(sentence(stands), "");
}

TEST_F(Expectations, TellAnglesInDegreesIfTheyWereGivenSo) {
  Expectation bent = of("Robot/KNEE/q");  // 0.5 rad
  bent.below = 0.1745329251994329;
  bent.angle = bent.degrees = true;
  EXPECT_EQ(sentence(bent), "expected Robot/KNEE/q below 10 deg: 28.6479 deg at tick 0 (0 s)");
}

TEST_F(Expectations, RefuseAnAngleOfWhatIsNone) {
  Expectation stands = of(height_);
  stands.above = 0.1;
  stands.angle = stands.degrees = true;
  EXPECT_THAT(sentence(stands), HasSubstr("Robot/BASE/position/z is no angle, but in m"));
}

TEST_F(Expectations, DoNotHoldBeyondTheEndOfTheRun) {
  Expectation stands = of(height_);
  stands.above = 0.0;
  stands.until = 0.01;
  EXPECT_THAT(sentence(stands), HasSubstr("until 0.01 s: the run ended at 0.004 s"));
  stands.until = std::nullopt;
  stands.at = 0.01;
  EXPECT_THAT(sentence(stands), HasSubstr("at 0.01 s: the run ended at 0.004 s"));
}

TEST_F(Expectations, OfTheEndDoNotHoldIfTheRunFailedBefore) {
  run_.outcome["failure"] = "controller 'Robot/Pd' threw";
  Expectation stands = of(height_);
  stands.above = 0.0;
  EXPECT_EQ(sentence(stands), "") << "so far it stood";
  stands.at_end = true;
  EXPECT_THAT(sentence(stands), HasSubstr("at the end: the run ended early, at 0.004 s"));
}

TEST_F(Expectations, AreUndecidedWithoutASampleInTheirSpan) {
  Expectation between = of(height_);
  between.above = 0.0;
  between.from = 0.0022;
  between.until = 0.0028;
  const ExpectationResult result = judged(between);
  EXPECT_TRUE(result.undecided);
  EXPECT_EQ(result.not_judged, std::vector<std::string>{height_});
  EXPECT_EQ(
      result.sentence,
      "undecided: Robot/BASE/position/z above 0 m from 0.0022 s until 0.0028 s: not judged, there is no sample in "
      "that span");
}

TEST_F(Expectations, JudgeNoSeriesThatIsNaNThroughoutAndNaNBesideNumbers) {
  for (testing::SmallTick& tick : run_.ticks) tick.u = nan_value;
  Expectation efforts = of("Robot/*/u");
  efforts.below = 15.0;
  EXPECT_THAT(sentence(efforts), HasSubstr("undecided: Robot/*/u below 15 N·m: not judged"));
  run_.has_helper = true;
  const ExpectationResult some = judged(efforts);
  EXPECT_TRUE(some.holds) << some.sentence;
  EXPECT_EQ(some.not_judged, std::vector<std::string>{"Robot/Pd/output/KNEE/u"});
  EXPECT_EQ(verdict({some}),
            "the expectation holds: Robot/*/u below 15; not judged: Robot/Pd/output/KNEE/u has no sample");
  run_.ticks[3].u = 12.0;
  EXPECT_THAT(sentence(efforts), HasSubstr("Robot/Pd/output/KNEE/u is nan N·m at tick 0"));
}

TEST_F(Expectations, AreDecidedIfNoTickOfTheirSpanIsMissing) {
  Expectation stands = of(height_);
  stands.above = 0.0;
  stands.until = 0.0045;
  EXPECT_EQ(sentence(stands), "");
  stands.until = 0.005;
  EXPECT_EQ(sentence(stands), "undecided: Robot/BASE/position/z above 0 m until 0.005 s: the run ended at 0.004 s");
  EXPECT_TRUE(judged(stands).undecided);
  Expectation quiet = of_event("error *", Expectation::Subject::no_event);
  quiet.until = 0.0045;
  EXPECT_EQ(sentence(quiet), "");
  quiet.until = 0.005;
  EXPECT_TRUE(judged(quiet).undecided);
}

TEST_F(Expectations, ThatAreUndecidedComeAfterThoseThatAreViolated) {
  Expectation late = of(height_), low = of(height_);
  late.above = low.above = 0.0;
  late.until = 1.0;
  low.above = 0.55;
  const Trace trace = run_.load(folder_ / "run.mcap");
  const auto results = judge_expectations({late, low}, trace);
  EXPECT_EQ(first_violation(results), &results[1]);
  EXPECT_THAT(verdict(results), HasSubstr("at worst 0.3 m at tick 4 (0.004 s); 1 more of 2 expectations is undecided"));
  CheckReport report;
  report.expectations = results;
  EXPECT_FALSE(report.undecided());
  report.expectations = {results[0]};
  EXPECT_TRUE(report.undecided());
  EXPECT_FALSE(report.within());
  report.closed = LevelState::differs;
  EXPECT_FALSE(report.undecided());
}

TEST_F(Expectations, WantAnEvent) {
  EXPECT_EQ(sentence(of_event("*goal is reached", Expectation::Subject::event)), "");
  EXPECT_EQ(sentence(of_event("error *", Expectation::Subject::event)), "expected an event \"error *\": there is none");
  Expectation late = of_event("note Robot/*", Expectation::Subject::event);
  late.from = 0.003;
  EXPECT_EQ(sentence(late), "expected an event \"note Robot/*\" from 0.003 s on: there is none");
}

TEST_F(Expectations, ForbidAnEvent) {
  EXPECT_EQ(sentence(of_event("error *", Expectation::Subject::no_event)), "");
  const ExpectationResult result = judged(of_event("*goal*", Expectation::Subject::no_event));
  EXPECT_EQ(result.sentence,
            "expected no event \"*goal*\": \"note Robot/Pd: the goal is reached\" at tick 2 (0.002 s)");
  ASSERT_TRUE(result.first);
  EXPECT_EQ(result.first->tick, 2);
  EXPECT_FALSE(result.first->value);
}

TEST_F(Expectations, TogetherAreJudgedByTheFirstViolation) {
  Expectation stands = of(height_), far = of("Robot/BASE/position/x"), unknown = of("Robot/NECK/q");
  Expectation lifts = of(height_);
  lifts.above = 2.0;
  lifts.sometime = true;  // never, and nearest at tick 0
  stands.above = 0.55;
  far.below = 5.0;
  unknown.above = 0.0;
  const Trace trace = run_.load(folder_ / "run.mcap");
  const auto results = judge_expectations({unknown, stands, far, lifts}, trace);
  EXPECT_EQ(first_violation(results), &results[2]) << "which is violated at tick 0";
  EXPECT_EQ(verdict(results),
            "expected Robot/BASE/position/x below 5 m: 10 m at tick 0 (0 s); 3 more of 4 expectations are violated");
  const Divergence place = divergence_of(results[1], trace);
  EXPECT_EQ(place.tick, 2);
  EXPECT_EQ(place.channel, "/Robot/BASE/pose");
  EXPECT_EQ(place.element, "position/z");
  EXPECT_EQ(place.stage, Stage::physics);
  EXPECT_EQ(place.note, results[1].sentence);
  EXPECT_EQ(divergence_of(results[0], trace).tick, 4) << "what no sample says is known at the end";
}

TEST_F(Expectations, SayThatAllHold) {
  Expectation stands = of(height_);
  stands.above = 0.0;
  const Trace trace = run_.load(folder_ / "run.mcap");
  EXPECT_EQ(verdict(judge_expectations({stands}, trace)), "the expectation holds: Robot/BASE/position/z above 0 m");
  EXPECT_EQ(verdict(judge_expectations({stands, stands}, trace)), "all 2 expectations hold");
  EXPECT_EQ(verdict(judge_expectations({}, trace)), "");
}

TEST(Horizon, IsTheScenariosThenTheEstimatedOne) {
  Scenario scenario;
  EXPECT_EQ(horizon_of(scenario), std::nullopt);
  EXPECT_EQ(horizon_of(scenario, 2.5), 2.5);
  scenario.horizon = 1.0;
  EXPECT_EQ(horizon_of(scenario, 2.5), 1.0);
}

}  // namespace
}  // namespace rehearse
