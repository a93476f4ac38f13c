#include <rehearse/check.h>
#include <rehearse/session.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "small_traces.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// SR1 for 50 ms with its cameras off, and its golden.
class Check : public ::testing::Test {
 protected:
  Check() : store_(folder_ / "golden", folder_ / "pending") {
    unsetenv("CI");  // messages advise differently there
    fs::create_directories(folder_ / "golden");
    auto scenario = Scenario::load(FIXTURES_DIR "/scenarios/sr1_standing.yaml");
    EXPECT_TRUE(scenario) << to_string(scenario.errors());
    scenario_ = std::move(*scenario);
    scenario_.duration = 0.05;
    scenario_.golden = "Robot.Stands";
  }

  void make_golden() {
    const auto report = check(GoldenMode::create);
    ASSERT_TRUE(report.golden_written) << report.verdict.text();
  }
  CheckReport check(GoldenMode mode = GoldenMode::check, const CheckOptions& options = {}) {
    auto report = check_golden(scenario_, store_, mode, options, {rehearse::record, run_plant});
    EXPECT_TRUE(report) << to_string(report.errors());
    return *report;
  }

  testing::TemporaryFolder folder_;
  GoldenStore store_;
  Scenario scenario_;
};

TEST_F(Check, FindsAnUnchangedProgramEqualOnAllLevels) {
  make_golden();
  const CheckReport report = check();
  EXPECT_EQ(report.controller, LevelState::equal) << report.verdict.text();
  EXPECT_EQ(report.closed, LevelState::equal) << report.verdict.text();
  EXPECT_EQ(report.plant, LevelState::equal) << report.verdict.text();
  EXPECT_EQ(report.plant_run->restored, 1);
  EXPECT_EQ(report.plant_run->from_the_start, "");
  EXPECT_TRUE(report.equal());
  EXPECT_THAT(report.verdict.text(), HasSubstr("equal bit for bit: 50 ticks"));
  EXPECT_FALSE(fs::exists(store_.pending_file("Robot.Stands")));
  EXPECT_FALSE(fs::exists(folder_ / "pending/plant/Robot.Stands.mcap"));
}

TEST_F(Check, BlamesPhysicsIfTheControllerRepeatsItself) {
  make_golden();
  scenario_.gravity.z() = -9.9;
  const CheckReport report = check();
  EXPECT_EQ(report.controller, LevelState::equal);
  EXPECT_EQ(report.plant, LevelState::differs);
  EXPECT_EQ(report.closed, LevelState::differs);
  EXPECT_FALSE(report.within());
  EXPECT_THAT(report.verdict.text(), HasSubstr("physics changed, the controller did not: under the golden's commands, "
                                               "SR1/WAIST/position/z is beyond ±1e-09 m from tick 1 (0.001 s) on"));
  EXPECT_THAT(report.verdict.text(),
              HasSubstr("scenario and models are what they were: the simulation itself changed"));
  EXPECT_TRUE(fs::exists(folder_ / "pending/plant/Robot.Stands.mcap"));
  EXPECT_THAT(report.message, HasSubstr("rehearse golden accept Robot.Stands"));
  EXPECT_TRUE(fs::exists(store_.pending_file("Robot.Stands")));
}

TEST_F(Check, ComparesOnlyTheLevelThatIsAskedFor) {
  make_golden();
  CheckOptions options;
  options.closed = options.plant = false;
  const CheckReport report = check(GoldenMode::check, options);
  EXPECT_EQ(report.controller, LevelState::equal);
  EXPECT_EQ(report.plant, LevelState::not_compared);
  EXPECT_EQ(report.closed, LevelState::not_compared);
  EXPECT_EQ(report.verdict.text(), "the controller repeats 50 recorded ticks bit for bit");
  std::swap(options.controller, options.plant);
  const CheckReport of_plant = check(GoldenMode::check, options);
  EXPECT_EQ(of_plant.plant, LevelState::equal);
  EXPECT_EQ(of_plant.controller, LevelState::not_compared);
  EXPECT_THAT(of_plant.verdict.text(), HasSubstr("the world under the recorded commands: equal bit for bit: 50 ticks"));
}

TEST_F(Check, BlamesByDoingThePartsAgainIfOnlyTheWholeIsAskedFor) {
  make_golden();
  scenario_.gravity.z() = -9.9;
  CheckOptions options;
  options.controller = options.plant = false;
  const CheckReport report = check(GoldenMode::check, options);
  ASSERT_TRUE(report.comparison && report.comparison->first);
  EXPECT_EQ(levels_text(report), fmt::format("controller: equal; plant: differs up to tick {}; closed: differs",
                                             report.comparison->first->tick));
  EXPECT_THAT(report.verdict.text(), HasSubstr("physics changed, the controller did not"));
}

TEST_F(Check, WithoutAGoldenDiffersAndSaysHowToGetOne) {
  const CheckReport report = check();
  EXPECT_FALSE(report.within());
  EXPECT_THAT(report.verdict.text(), HasSubstr("there is no golden"));
  EXPECT_THAT(report.message, HasSubstr("rehearse golden accept Robot.Stands"));
}

TEST_F(Check, ReplacesTheGoldenIfToldSo) {
  make_golden();
  scenario_.gravity.z() = -9.9;
  EXPECT_TRUE(check(GoldenMode::accept).golden_written);
  EXPECT_TRUE(check().comparison->equal);
}

TEST_F(Check, NeedsAScenarioThatNamesItsGolden) {
  scenario_.golden = "";
  const auto report = check_golden(scenario_, store_, GoldenMode::check, {}, {rehearse::record, run_plant});
  ASSERT_FALSE(report);
  EXPECT_THAT(report.errors()[0].message, HasSubstr("names no golden"));
}

/// The waist is to be above that height [m] all the time; it starts at 0.7135 m.
Expectation waist_above(double height) {
  Expectation expectation;
  expectation.pattern = "SR1/WAIST/position/z";
  expectation.above = height;
  expectation.place = {"stands.yaml", 12, 5};
  return expectation;
}

TEST_F(Check, ComparesAWholeRunUpToItsHorizon) {
  make_golden();
  Push push;
  push.body = 1;
  push.force.x() = 50.0;  // [N]
  push.from = 0.03;       // [s]
  push.until = 0.05;
  scenario_.pushes.push_back(push);
  CheckOptions options;
  options.controller = options.plant = false;
  EXPECT_FALSE(check(GoldenMode::check, options).within());
  options.estimated_horizon = 0.03;
  const CheckReport estimated = check(GoldenMode::check, options);
  EXPECT_EQ(estimated.closed, LevelState::equal);
  EXPECT_THAT(estimated.verdict.text(), HasSubstr("up to 0.03 s equal bit for bit: 31 ticks"));
  EXPECT_THAT(to_json(estimated), HasSubstr(R"("horizon": 0.03)"));
  scenario_.horizon = 0.04;
  EXPECT_FALSE(check(GoldenMode::check, options).within()) << "what is stated counts more than what is estimated";
}

TEST_F(Check, SaysThatARunIsAsExpectedBesideHowItCompares) {
  make_golden();
  scenario_.expectations = {waist_above(0.7)};
  const CheckReport report = check();
  EXPECT_TRUE(report.equal());
  EXPECT_THAT(report.verdict.text(), HasSubstr("equal bit for bit: 50 ticks"));
  EXPECT_THAT(report.verdict.text(), HasSubstr("; the expectation holds: SR1/WAIST/position/z above 0.7 m"));
}

TEST_F(Check, DiffersIfARunIsNotAsExpectedHoweverItCompares) {
  make_golden();
  scenario_.expectations = {waist_above(2.0), waist_above(0.7)};
  const CheckReport report = check();
  EXPECT_EQ(report.controller, LevelState::equal);
  EXPECT_EQ(report.plant, LevelState::equal);
  EXPECT_EQ(report.closed, LevelState::equal);
  EXPECT_FALSE(report.within());
  EXPECT_THAT(report.verdict.text(),
              ::testing::StartsWith("expected SR1/WAIST/position/z above 2 m: 0.7135 m at tick 0 (0 s), at worst "));
  EXPECT_THAT(report.verdict.text(), HasSubstr("; equal bit for bit: 50 ticks"));
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->channel, "/SR1/WAIST/pose");
  EXPECT_EQ(report.first->tick, 0);
  EXPECT_THAT(report.message, HasSubstr("\nstands.yaml:12: expected SR1/WAIST/position/z above 2 m"));
  EXPECT_TRUE(fs::exists(store_.pending_file("Robot.Stands")));
  const std::string json = to_json(report);
  EXPECT_THAT(json, HasSubstr(R"("text": "SR1/WAIST/position/z above 2 m",
      "line": 12,
      "holds": false,
      "first": {
        "series": "SR1/WAIST/position/z",
        "tick": 0,
        "time": 0.0,
        "value": 0.7135
      })"));
  EXPECT_THAT(json, HasSubstr(R"("holds": true,
      "first": null)"));
}

TEST_F(Check, SaysFirstThatTheRunIsNotAsExpectedAndThenBlamesThePart) {
  make_golden();
  scenario_.gravity.z() = -9.9;
  scenario_.expectations = {waist_above(2.0)};
  const CheckReport report = check();
  EXPECT_THAT(report.verdict.text(), ::testing::StartsWith("expected SR1/WAIST/position/z above 2 m: "));
  EXPECT_THAT(report.verdict.text(), HasSubstr("; physics changed"));
  EXPECT_EQ(report.first->note, "") << "the values differ before";
}

TEST_F(Check, MakesNoGoldenOfARunThatIsNotAsExpected) {
  scenario_.expectations = {waist_above(2.0)};
  const CheckReport first = check(GoldenMode::create);
  EXPECT_FALSE(first.golden_written);
  EXPECT_FALSE(first.within());
  EXPECT_FALSE(store_.has("Robot.Stands"));
  scenario_.expectations.clear();
  make_golden();
  scenario_.expectations = {waist_above(2.0)};
  const CheckReport replaced = check(GoldenMode::accept);
  EXPECT_FALSE(replaced.golden_written);
  EXPECT_FALSE(replaced.within());
}

TEST_F(Check, OfAScenarioWithoutAGoldenIsByItsExpectationsAlone) {
  scenario_.golden = "";
  scenario_.expectations = {waist_above(0.7)};
  const CheckReport good = check();
  EXPECT_EQ(good.closed, LevelState::not_compared) << "there is nothing that it could equal";
  EXPECT_TRUE(good.within());
  EXPECT_EQ(good.verdict.text(), "the expectation holds: SR1/WAIST/position/z above 0.7 m");
  EXPECT_FALSE(fs::exists(folder_ / "pending/sr1_standing.mcap"));
  scenario_.expectations = {waist_above(2.0)};
  const CheckReport bad = check();
  EXPECT_EQ(bad.closed, LevelState::not_compared);
  EXPECT_FALSE(bad.within());
  EXPECT_TRUE(fs::exists(folder_ / "pending/sr1_standing.mcap"));
  CheckOptions controller_only;
  controller_only.closed = controller_only.plant = false;
  EXPECT_FALSE(check_golden(scenario_, store_, GoldenMode::check, controller_only, {rehearse::record, run_plant}))
      << "a controller has nothing to be compared with";
}

TEST_F(Check, ReportsEachLevelAsJson) {
  make_golden();
  EXPECT_THAT(to_json(check()), HasSubstr(R"("levels": {
    "controller": "equal",
    "plant": "equal",
    "closed": "equal"
  },
  "first": null)"));
}

}  // namespace
}  // namespace rehearse
