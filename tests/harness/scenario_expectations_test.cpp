// Reading a scenario's expectations. fixtures/broken has the mistakes.
#include "scenario_files.h"

#include <gmock/gmock.h>

#include <numbers>

namespace rehearse {
namespace {

using Subject = Expectation::Subject;

std::string run_with(const std::string& lines) {
  return "rehearse: 1\nduration: 10\nbodies:\n  - {name: Box, sphere: {radius: 0.1}, mass: 1}\n" + lines;
}

/// The only expectation of a scenario that must be valid.
Expectation expectation(const std::string& entry) {
  const Scenario scenario = loaded(run_with("expect:\n  - " + entry + "\n"));
  EXPECT_EQ(scenario.expectations.size(), 1u);
  return scenario.expectations.empty() ? Expectation{} : scenario.expectations[0];
}

TEST(ScenarioHorizon, IsATimeInTheRun) {
  EXPECT_EQ(loaded(run_with("")).horizon, std::nullopt);
  EXPECT_EQ(loaded(run_with("horizon: 2.5\n")).horizon, 2.5);
  EXPECT_EQ(loaded(run_with("horizon: 0\n")).horizon, 0.0) << "no values but those of the start";
  EXPECT_EQ(loaded(run_with("horizon: 10\n")).horizon, 10.0);
}

TEST(ScenarioExpectations, BoundASeriesFromOneSideOrBoth) {
  const Expectation stands = expectation("{channel: Box/Box/position/z, above: 0.6, from: 2, until: 9.5}");
  EXPECT_EQ(stands.subject, Subject::series);
  EXPECT_EQ(stands.pattern, "Box/Box/position/z");
  EXPECT_EQ(stands.above, 0.6);
  EXPECT_EQ(stands.below, std::nullopt);
  EXPECT_EQ(stands.from, 2.0);
  EXPECT_EQ(stands.until, 9.5);
  EXPECT_EQ(stands.place.line, 6);
  EXPECT_EQ(stands.place.column, 15);
  const Expectation between = expectation("{channel: \"Box/*\", below: 1, above: -1}");
  EXPECT_EQ(between.above, -1.0);
  EXPECT_EQ(between.below, 1.0);
}

TEST(ScenarioExpectations, BoundADistanceAtOneMoment) {
  const Expectation goal = expectation("{channel: Box/Box/position/x, near: 1, within: 0.05, at: end}");
  EXPECT_EQ(goal.near, 1.0);
  EXPECT_EQ(goal.within, 0.05);
  EXPECT_TRUE(goal.at_end);
  EXPECT_FALSE(goal.at);
  EXPECT_EQ(expectation("{channel: a/x, above: 1, at: 3.5}").at, 3.5);
}

TEST(ScenarioExpectations, MayBeExpressionsOverTime) {
  const Expectation responds = expectation(
      "{always: \"Box/Box/z > 1\", within: 0.5 s, after: \"contact(Box)\", from: 1 s, until: 2000 ms, margin: 10 %}");
  EXPECT_EQ(responds.subject, Subject::expression);
  EXPECT_EQ(responds.quantifier, Expectation::Quantifier::always);
  EXPECT_EQ(responds.expression, "Box/Box/z > 1");
  EXPECT_EQ(responds.after, "contact(Box)");
  EXPECT_EQ(responds.delay, 0.5);
  EXPECT_EQ(responds.from, 1.0);
  EXPECT_EQ(responds.until, 2.0);
  ASSERT_TRUE(responds.margin);
  EXPECT_TRUE(responds.margin->is_share);
  EXPECT_DOUBLE_EQ(responds.margin->least, 0.1);
  EXPECT_THAT(responds.names, ::testing::Contains("*/Box/Box/position/z"));
  EXPECT_EQ(responds.place.column, 14);
  const Expectation settles = expectation("{never: time > 9, except: \"step(Box/Box/z)\", for: 0.3 s, margin: 2 deg}");
  EXPECT_EQ(settles.quantifier, Expectation::Quantifier::never);
  EXPECT_EQ(settles.lasting, 0.3);
  EXPECT_TRUE(settles.margin->angle && !settles.margin->is_share);
  EXPECT_EQ(expectation("{eventually: \"time > 1\"}").quantifier, Expectation::Quantifier::eventually);
}

TEST(ScenarioExpectations, TakeAnglesWithTheirUnit) {
  const Expectation bent = expectation("{channel: Arm/KNEE/q, above: -90 deg, below: 0.5 rad}");
  EXPECT_NEAR(*bent.above, -std::numbers::pi / 2.0, 1e-15);
  EXPECT_EQ(bent.below, 0.5);
  EXPECT_TRUE(bent.angle);
  EXPECT_TRUE(bent.degrees);
  const Expectation plain = expectation("{channel: Arm/KNEE/q, near: 0, within: 0.5 rad}");
  EXPECT_TRUE(plain.angle);
  EXPECT_FALSE(plain.degrees);
  EXPECT_FALSE(expectation("{channel: a/x, above: 1}").angle);
}

TEST(ScenarioExpectations, BoundAMagnitudeOrAChange) {
  EXPECT_TRUE(expectation("{channel: \"Arm/*/u\", abs: true, below: 80}").absolute);
  const Expectation drift = expectation("{channel: a/x, since: 5, near: 0, within: 0.01}");
  EXPECT_EQ(drift.since, 5.0);
  EXPECT_EQ(drift.from, 5.0) << "what was before isn't a change since then";
  EXPECT_EQ(expectation("{channel: a/x, since: 5, from: 6, above: 0}").from, 6.0);
  EXPECT_EQ(expectation("{channel: a/x, since: 5, at: end, above: 0}").from, std::nullopt);
}

TEST(ScenarioExpectations, MayBeContentWithOneSample) {
  EXPECT_TRUE(expectation("{channel: a/count, below: 1, sometime: true}").sometime);
  EXPECT_FALSE(expectation("{channel: a/count, below: 1}").sometime);
}

TEST(ScenarioExpectations, WantOrForbidEvents) {
  const Expectation wanted = expectation("{event: \"*reached*\", until: 5}");
  EXPECT_EQ(wanted.subject, Subject::event);
  EXPECT_EQ(wanted.pattern, "*reached*");
  EXPECT_EQ(wanted.until, 5.0);
  EXPECT_EQ(expectation("no_event: error *").subject, Subject::no_event);
}

TEST(ScenarioExpectations, TellAllMistakesOfSeveralEntries) {
  const auto result =
      load_text(run_with("horizon: 11\n"
                         "expect:\n"
                         "  - {channel: a/x, above: 2, below: 1, from: 20}\n"
                         "  - {channel: a/x}\n"
                         "  - {event: a, abs: true}\n"));
  ASSERT_FALSE(result.ok());
  const std::vector<std::pair<int, int>> places{{5, 10}, {7, 27}, {7, 46}, {8, 5}, {9, 16}};
  ASSERT_EQ(result.errors().size(), places.size()) << mistakes(result);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(result.errors()[i].line, places[i].first) << mistakes(result);
    EXPECT_EQ(result.errors()[i].column, places[i].second) << mistakes(result);
  }
}

TEST(ScenarioExpectations, OfAScenarioWithABadDurationAreJudgedWithoutIt) {
  const auto result = load_text(
      "rehearse: 1\nduration: -1\nhorizon: 5\n"
      "bodies:\n  - {name: Box, sphere: {radius: 0.1}, mass: 1}\n"
      "expect: [{channel: a/x, above: 1, from: 3}]\n");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.errors().size(), 1u) << mistakes(result);
}

}  // namespace
}  // namespace rehearse
