// Expectations that are expressions, and margins of all expectations, judged on recordings made by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/check.h>
#include <rehearse/scenario.h>

#include "core/check/check_json.h"
#include "core/check/unknown_series.h"
#include "core/scenario/declared_source.h"
#include "small_traces.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using testing::nan_value;
using testing::SmallTrace;
using testing::TemporaryFolder;
using Quantifier = Expectation::Quantifier;

/// Five ticks of 1 ms, in which the base sinks from 0.7 m by 0.1 m a tick, a foot that touches the floor from tick 2 to
/// 3, and one event.
class Formulas : public ::testing::Test {
 protected:
  Formulas() {
    run_.ticks = {{0}, {1}, {2}, {3}, {4}};
    for (std::size_t i = 0; i < run_.ticks.size(); ++i) {
      run_.ticks[i].position[2] = 0.7 - 0.1 * static_cast<double>(i);
      run_.ticks[i].q = 0.1 * static_cast<double>(i);
    }
    run_.outcome = {{"ticks", "5"}, {"complete", "true"}};
    run_.events = {{msg::Time::from_ns(2'000'000), 2, "note", "Robot/Pd", "the goal is reached"}};
    run_.contact_changes = {{msg::Time::from_ns(2'000'000), 2, "Robot/FOOT", "Floor/Floor", true},
                            {msg::Time::from_ns(4'000'000), 4, "Robot/FOOT", "Floor/Floor", false}};
  }

  static Expectation of(Quantifier quantifier, const std::string& expression) {
    Expectation expectation;
    expectation.subject = Expectation::Subject::expression;
    expectation.quantifier = quantifier;
    expectation.expression = expression;
    expectation.place = {"run.yaml", 5, 14};
    return expectation;
  }

  /// Judged as a whole; the file, tick by tick, must give the same.
  ExpectationResult judged(Expectation expectation) {
    if (expectation.subject == Expectation::Subject::expression) {
      EXPECT_TRUE(declare_expressions(Scenario(), expectation).empty());
    }
    const Trace trace = run_.load(folder_ / "run.mcap");
    const ExpectationResult result = judge_expectations({expectation}, trace)[0];
    for (const std::size_t piece : {std::size_t{1}, std::size_t{1000}, Trace::usual_piece_size}) {
      const auto in_pieces = judge_expectations({expectation}, folder_ / "run.mcap", piece);
      EXPECT_TRUE(in_pieces) << to_string(in_pieces.errors());
      EXPECT_EQ(json_of((*in_pieces)[0]).dump(), json_of(result).dump());
      EXPECT_EQ((*in_pieces)[0].sentence, result.sentence);
    }
    EXPECT_EQ(result.holds, result.sentence.empty()) << result.sentence;
    return result;
  }
  ExpectationResult always(const std::string& expression) { return judged(of(Quantifier::always, expression)); }
  ExpectationResult eventually(const std::string& expression) { return judged(of(Quantifier::eventually, expression)); }
  ExpectationResult never(const std::string& expression) { return judged(of(Quantifier::never, expression)); }

  TemporaryFolder folder_;
  SmallTrace run_;
};

TEST_F(Formulas, HoldWithTheirClosestPlace) {
  const ExpectationResult result = always("BASE/z > 0.2 m");
  EXPECT_TRUE(result.holds);
  EXPECT_EQ(closest_text(result), "closest: 0.3 of 0.2 m at tick 4 (0.004 s), margin 50 %");
  ASSERT_TRUE(result.margin);
  EXPECT_NEAR(*result.margin, 0.1, 1e-12);
  EXPECT_EQ(result.closest->unit, "m");
  EXPECT_NEAR(*result.closest->share, 0.5, 1e-12);
}

TEST_F(Formulas, HaveTheMarginZeroWithoutASign) {
  const ExpectationResult result = always("Robot/Foot/force/z == 0.65 kN");
  EXPECT_THAT(closest_text(result), ::testing::EndsWith(", margin 0 %"));
  ASSERT_TRUE(result.margin);
  EXPECT_FALSE(std::signbit(*result.margin));
  EXPECT_FALSE(std::signbit(result.closest->margin));
}

TEST_F(Formulas, TellTheFirstAndTheWorstTickThatViolates) {
  const ExpectationResult result = always("BASE/z > 0.55 m");
  EXPECT_EQ(result.sentence,
            "expected always BASE/z > 0.55 m: 0.5 of 0.55 m at tick 2 (0.002 s), at worst 0.3 of "
            "0.55 m at tick 4 (0.004 s)");
  ASSERT_TRUE(result.first && result.worst);
  EXPECT_EQ(result.first->tick, 2);
  EXPECT_EQ(result.worst->tick, 4);
  EXPECT_NEAR(*result.margin, -0.25, 1e-12);
}

TEST_F(Formulas, CompareSeriesInTheirUnits) {
  EXPECT_TRUE(always("q(KNEE) < 23 deg").holds);
  EXPECT_EQ(closest_text(always("q(KNEE) < 23 deg")), "closest: 22.9183 of 23 deg at tick 4 (0.004 s), margin 0.355 %");
  EXPECT_TRUE(always("Robot/Foot/force/z == 0.65 kN").holds);
  const ExpectationResult wrong = always("q(KNEE) < 1 m");
  EXPECT_FALSE(wrong.holds);
  ASSERT_TRUE(wrong.problem);
  EXPECT_EQ(
      to_string(*wrong.problem),
      "run.yaml:5:24: error: < takes numbers of one unit, and these are in rad and m\n  q(KNEE) < 1 m\n            ^ "
      "(rehearse doc expressions describes the language)");
}

TEST_F(Formulas, SeeContactsAndEvents) {
  EXPECT_TRUE(eventually("contact(FOOT)").holds);
  EXPECT_TRUE(eventually("contact(FOOT, Floor)").holds);
  EXPECT_FALSE(eventually("contact(BASE)").holds);
  EXPECT_TRUE(always("contact(FOOT) == (tick == 2 || tick == 3)").holds);
  EXPECT_TRUE(eventually("message('*goal*') && tick == 2").holds);
  EXPECT_TRUE(never("event('error *')").holds);
  EXPECT_TRUE(eventually("event('note Robot/Pd: the goal is reached')").holds);
  EXPECT_EQ(always("contact(FOOT)").sentence, "expected always contact(FOOT): not so at tick 0 (0 s)");
  EXPECT_FALSE(always("contact(FOOT)").margin) << "nothing is compared";
}

TEST_F(Formulas, FollowATrigger) {
  Expectation responds = of(Quantifier::always, "BASE/z < 0.45");
  responds.after = "contact(FOOT)";
  responds.delay = 0.001;
  EXPECT_TRUE(judged(responds).holds) << "0.5 m in tick 2, 0.4 m in tick 3";
  responds.expression = "BASE/z < 0.35";
  EXPECT_EQ(judged(responds).sentence,
            "expected always BASE/z < 0.35 within 0.001 s after contact(FOOT): not so at tick 2 (0.002 s): 0.4 of "
            "0.35 m at tick 3");
}

TEST_F(Formulas, AreUndecidedIfTheRunEndsInAWindow) {
  Expectation responds = of(Quantifier::always, "BASE/z < 0.2");
  responds.after = "contact(FOOT)";
  responds.delay = 0.5;
  const ExpectationResult result = judged(responds);
  EXPECT_TRUE(result.undecided);
  EXPECT_FALSE(result.holds) << "undecided is not true";
  EXPECT_EQ(result.sentence,
            "undecided: always BASE/z < 0.2 within 0.5 s after contact(FOOT): the run ended at 0.004 s, "
            "within the time from tick 2 on");
  EXPECT_FALSE(result.margin);
  Expectation late = of(Quantifier::always, "BASE/z > 0");
  late.until = 1.0;
  EXPECT_THAT(judged(late).sentence, HasSubstr("undecided: always BASE/z > 0, until 1 s: the run ended at 0.004 s"));
}

TEST_F(Formulas, TakeValuesOfTheTickBeforeAndOfATime) {
  EXPECT_TRUE(always("tick == 0 || abs(delta(BASE/z) + 0.1) < 1e-9").holds);
  EXPECT_TRUE(always("time < 0.002 || BASE/z <= at(Robot/BASE/position/z, 0.002 s)").holds);
  EXPECT_TRUE(always("tick < 4 || prev(prev(prev(prev(q(KNEE))))) == 0").holds);
}

TEST_F(Formulas, AreViolatedByNaN) {
  run_.ticks[3].position[2] = nan_value;
  EXPECT_EQ(always("BASE/z > 0").sentence, "expected always BASE/z > 0: a number is NaN at tick 3 (0.003 s)");
  EXPECT_EQ(never("BASE/z > 9").sentence, "expected never BASE/z > 9: a number is NaN at tick 3 (0.003 s)");
  EXPECT_TRUE(eventually("BASE/z < 0.35").holds);
}

TEST_F(Formulas, BeginWithTheFirstNumberUnlessNaNCameBeforeIt) {
  const std::string effort = "Robot/Pd/output/KNEE/u";
  for (testing::SmallTick& tick : run_.ticks) tick.u = nan_value;
  EXPECT_EQ(always("abs(" + effort + ") < 15").sentence,
            "undecided: always abs(Robot/Pd/output/KNEE/u) < 15: not judged, Robot/Pd/output/KNEE/u has no sample");
  const ExpectationResult other = always("BASE/z > 0 || abs(" + effort + ") < 15");
  EXPECT_TRUE(other.holds);
  EXPECT_EQ(other.not_judged, std::vector<std::string>{effort});
  run_.ticks[3].u = 12.0;
  EXPECT_EQ(always("abs(" + effort + ") < 15").sentence,
            "expected always abs(Robot/Pd/output/KNEE/u) < 15: a number is NaN at tick 0 (0 s)");
  EXPECT_TRUE(eventually("abs(" + effort + ") < 15").holds);
  EXPECT_TRUE(always("abs(delta(BASE/z)) < 0.2").holds) << "there is no tick before the first";
}

TEST_F(Formulas, DemandAMargin) {
  Expectation stands = of(Quantifier::always, "BASE/z > 0.2 m");
  stands.margin = Expectation::Margin{0.5, true, false, "50 %"};
  EXPECT_FALSE(judged(stands).holds) << "0.1 is less than half of 0.2, by rounding";
  stands.margin = Expectation::Margin{0.49, true, false, "49 %"};
  EXPECT_TRUE(judged(stands).holds);
  stands.margin = Expectation::Margin{0.6, true, false, "60 %"};
  EXPECT_EQ(judged(stands).sentence,
            "expected always BASE/z > 0.2 m: its margin is less than 60 %: 0.3 of 0.2 m at tick "
            "4 (0.004 s), margin 50 %");
  stands.margin = Expectation::Margin{0.05, false, false, "0.05"};
  EXPECT_TRUE(judged(stands).holds);
  stands.expression = "BASE/z > 0 m";
  stands.margin = Expectation::Margin{0.1, true, false, "10 %"};
  EXPECT_THAT(judged(stands).sentence, HasSubstr("the bound is 0, of which a margin can't be a share"));
}

TEST_F(Formulas, OfBoundsOfASeriesAreTranslated) {
  Expectation stands;
  stands.pattern = "Robot/BASE/position/z";
  stands.above = 0.25;
  const ExpectationResult result = judged(stands);
  EXPECT_EQ(result.formula, "always 'Robot/BASE/position/z' > 0.25");
  EXPECT_EQ(closest_text(result), "closest: 0.3 of 0.25 m at tick 4 (0.004 s), margin 20 %");
  EXPECT_EQ(always("Robot/BASE/position/z > 0.25").margin, result.margin);
  stands.margin = Expectation::Margin{0.3, true, false, "30 %"};
  EXPECT_THAT(judged(stands).sentence, HasSubstr("above 0.25 m: its margin is less than 30 %"));
  stands = Expectation();
  stands.pattern = "Robot/BASE/position/z";
  stands.near = 0.5;
  stands.within = 0.3;
  stands.since = 0.001;
  stands.sometime = true;
  EXPECT_EQ(judged(stands).formula,
            "eventually abs(('Robot/BASE/position/z' - at('Robot/BASE/position/z', 0.001 s)) - 0.5) <= 0.3");
}

TEST_F(Formulas, AreRefusedWithNamesThatNoRunHas) {
  Expectation misspelt = of(Quantifier::always, "BASSE/position/z > 0");
  const ExpectationResult result = judged(misspelt);
  ASSERT_TRUE(result.problem);
  EXPECT_THAT(result.sentence, HasSubstr("there is no series 'BASSE/position/z' (did you mean 'BASE/position/z'"));
  Scenario scenario;
  ASSERT_TRUE(declare_expressions(scenario, misspelt).empty());
  scenario.expectations = {misspelt, of(Quantifier::always, "BASE/z > 0")};
  const Trace trace = run_.load(folder_ / "run.mcap");
  const std::vector<const Trace*> traces{&trace};
  const Diagnostics errors = unknown_series(scenario, traces);
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_THAT(to_string(errors[0]), HasSubstr("run.yaml:5:14: error: there is no series 'BASSE/position/z'"));
  EXPECT_THAT(to_string(errors[0]), HasSubstr("\n  BASSE/position/z > 0\n  ^ (did you mean"));
}

TEST_F(Formulas, AreInJsonWithTheirMargin) {
  const auto json = json_of(always("BASE/z > 0.2 m"));
  EXPECT_EQ(json["holds"], true);
  EXPECT_EQ(json["undecided"], false);
  EXPECT_NEAR(json["margin"].get<double>(), 0.1, 1e-12);
  EXPECT_EQ(json["closest"]["tick"], 4);
  EXPECT_EQ(json["closest"]["unit"], "m");
  EXPECT_NEAR(json["closest"]["share"].get<double>(), 0.5, 1e-12);
  EXPECT_TRUE(json_of(always("contact(FOOT)"))["closest"].is_null());
}

}  // namespace
}  // namespace rehearse
