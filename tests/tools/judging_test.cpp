// The verbs that give verdicts: check, diff and golden, in a folder like a user's repository.
#include "command.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

namespace rehearse::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string golden_of_robot = "golden/Robot.Stands.mcap";
const std::string pending_of_robot = "rehearse-pending/Robot.Stands.mcap";
const std::string changed_gain = "SR1Minimum=" CHANGED_GAIN;

/// A repository with one scenario that names a golden, and one that doesn't.
class Repository : public Command {
 protected:
  Repository() {
    fs::create_directories(folder() / "fixtures/scenarios");
    fs::create_directories(folder() / "golden");
    std::string text = read_file(sr1_without_cameras());
    const std::string before = "golden: SR1.StandsUnderItsMinimumController";
    const std::size_t at = text.find(before);
    EXPECT_NE(at, std::string::npos);
    write("fixtures/scenarios/stands.yaml", text.replace(at, before.size(), "golden: Robot.Stands"));
    fs::copy_file(box_scenario, folder() / "fixtures/scenarios/drop_box.yaml");
  }
  const std::string scenario_ = "fixtures/scenarios/stands.yaml";

  void accept_golden() const {
    EXPECT_EQ(rehearse({"check", scenario_}).status, 1);
    done({"golden", "accept", "Robot.Stands"});
  }
};

class Check : public Repository {};
class Golden : public Repository {};
class Diff : public Repository {
 protected:
  /// a.mcap, and b.mcap with the changed gain.
  void record_two() const {
    done({"record", scenario_, "-o", "a.mcap"});
    done({"record", scenario_, "-o", "b.mcap", "--controller", changed_gain});
  }
};

TEST_F(Check, EndsWithFourIfAnExpectationIsUndecided) {
  const std::string undecided = "{always: \"prev(Box/Box/position/z) > 0\", until: 0}";
  write("early.yaml", read_file(box_scenario) + "expect: [" + undecided + "]\n");
  const Outcome early = rehearse({"check", "early.yaml"});
  EXPECT_EQ(early.status, 4) << early.err;
  EXPECT_THAT(early.out, HasSubstr("undecided: always prev(Box/Box/position/z) > 0, until 0 s: not judged"));
  const nlohmann::json report = rehearse({"check", "early.yaml", "--json"}).json();
  EXPECT_EQ(report["code"], "expectations.undecided");
  EXPECT_EQ(report["within"], false);
  EXPECT_EQ(report["expectations"][0]["undecided"], true);
  write("both.yaml",
        read_file(box_scenario) + "expect: [" + undecided + ", {channel: Box/Box/position/z, above: 0.3}]\n");
  EXPECT_EQ(rehearse({"check", "both.yaml"}).status, 1) << "what is violated counts more";
  const Outcome all = rehearse({"check", "early.yaml", "both.yaml"});
  EXPECT_EQ(all.status, 1) << "a difference is worse than what is undecided";
}

TEST_F(Check, FailsWithoutAGoldenAndSaysHowTheRunBecomesOne) {
  const Outcome outcome = rehearse({"check", scenario_});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, HasSubstr("there is no golden golden/Robot.Stands.mcap"));
  EXPECT_THAT(outcome.out, HasSubstr("rehearse golden accept Robot.Stands\n"));
  EXPECT_FALSE(exists(golden_of_robot));
  EXPECT_TRUE(exists(pending_of_robot));
}

TEST_F(Check, PassesARunThatIsAsItsGolden) {
  accept_golden();
  const Outcome outcome = done({"check", scenario_});
  EXPECT_THAT(outcome.out, StartsWith("sr1_minimum: equal bit for bit: 100 ticks, "));
  EXPECT_THAT(outcome.out, HasSubstr("\n  controller: equal; plant: equal; closed: equal; "));
  EXPECT_FALSE(exists(pending_of_robot));
}

TEST_F(Check, WithoutAScenarioRunsAllThatNameAGolden) {
  accept_golden();
  const nlohmann::json report = done({"check", "--json"}).json();
  EXPECT_EQ(report["file"], scenario_);
  EXPECT_EQ(report["equal"], true);
}

TEST_F(Check, WithoutAScenarioRunsThoseThatExpectSomethingAsWell) {
  accept_golden();
  write("fixtures/scenarios/falls.yaml",
        read_file(box_scenario) + "expect: [{channel: Box/Box/position/z, below: 0.11, at: end}]\n");
  const nlohmann::json report = done({"check", "--json"}).json();
  ASSERT_EQ(report["scenarios"].size(), 2u);
  EXPECT_EQ(report["verdict"], "2 scenarios as they should be");
  const nlohmann::json& falls = report["scenarios"][0];
  EXPECT_EQ(falls["levels"]["closed"], "not compared");
  EXPECT_EQ(falls["levels"]["plant"], "not compared");
  EXPECT_EQ(falls["expectations"][0]["text"], "Box/Box/position/z below 0.11 m at the end");
  EXPECT_EQ(falls["expectations"][0]["holds"], true);
}

TEST_F(Check, EndsInOneIfARunIsNotAsExpected) {
  write("falls.yaml", read_file(box_scenario) + "expect: [{channel: Box/Box/position/z, above: 0.3}]\n");
  const Outcome outcome = rehearse({"check", "falls.yaml"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, StartsWith("drop_box: expected Box/Box/position/z above 0.3 m: 0.29"));
  EXPECT_THAT(outcome.out, HasSubstr("controller: not compared; plant: not compared; closed: not compared"));
  EXPECT_THAT(outcome.out, HasSubstr("\nfalls.yaml:"));
  EXPECT_TRUE(exists("rehearse-pending/drop_box.mcap"));
  const nlohmann::json report = rehearse({"check", "falls.yaml", "--json"}).json();
  EXPECT_EQ(report["within"], false);
  EXPECT_EQ(report["first"]["channel"], "/Box/Box/pose");
  EXPECT_EQ(report["first"]["tick"], report["expectations"][0]["first"]["tick"]);
}

TEST_F(Check, AnswersInJson) {
  accept_golden();
  const nlohmann::json report = done({"check", scenario_, "--json"}).json();
  EXPECT_THAT(report["verdict"].get<std::string>(), StartsWith("equal bit for bit: "));
  EXPECT_EQ(report["equal"], true);
  EXPECT_EQ(report["within"], true);
  EXPECT_EQ(report["first"], nullptr);
  EXPECT_EQ(report["levels"], nlohmann::json({{"controller", "equal"}, {"plant", "equal"}, {"closed", "equal"}}));
}

TEST_F(Check, AnswersForSeveralScenariosInOneObject) {
  accept_golden();
  const nlohmann::json report = done({"check", scenario_, scenario_, "--json"}).json();
  EXPECT_EQ(report["verdict"], "2 scenarios as they should be");
  EXPECT_EQ(report["levels"]["closed"], "equal");
  EXPECT_EQ(report["first"], nullptr);
  EXPECT_EQ(report["scenarios"].size(), 2u);
}

TEST_F(Check, FindsAChangedGainAtTheTickInWhichItFirstActs) {
  accept_golden();
  const std::string golden = read_file(folder() / golden_of_robot);
  const nlohmann::json replayed = rehearse({"replay", golden_of_robot, "--json", "--controller", changed_gain}).json();

  const Outcome outcome = rehearse({"check", scenario_, "--json", "--controller", changed_gain});
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const nlohmann::json report = outcome.json();
  EXPECT_EQ(report["equal"], false);
  EXPECT_EQ(report["within"], false);
  EXPECT_EQ(report["levels"]["controller"], "differs");
  EXPECT_EQ(report["first"]["stage"], "controller");
  EXPECT_EQ(report["first"]["element"], "RLEG_KNEE/u");
  EXPECT_EQ(report["first"]["tick"], replayed["beyond"]["tick"]);
  EXPECT_THAT(report["verdict"].get<std::string>(), HasSubstr("the controller changed"));
  EXPECT_TRUE(read_file(folder() / golden_of_robot) == golden);
}

TEST_F(Check, ComparesTheAskedLevelsOnly) {
  accept_golden();
  const nlohmann::json report = done({"check", scenario_, "--json", "--level", "controller"}).json();
  EXPECT_EQ(report["levels"]["controller"], "equal");
  EXPECT_EQ(report["levels"]["closed"], "not compared");
  const nlohmann::json all = done({"check", scenario_, "--json", "--level", "controller,plant,closed"}).json();
  EXPECT_EQ(all["levels"]["closed"], "equal");
  EXPECT_EQ(all["levels"]["plant"], "equal");
  const nlohmann::json plant = done({"check", scenario_, "--json", "--level", "plant"}).json();
  EXPECT_EQ(plant["levels"],
            nlohmann::json({{"controller", "not compared"}, {"plant", "proved"}, {"closed", "not compared"}}));
}

TEST_F(Check, ComparesWithATraceThatIsNamed) {
  done({"record", scenario_, "-o", "yesterday.mcap"});
  done({"check", scenario_, "--golden", "yesterday.mcap"});
  EXPECT_EQ(rehearse({"check", scenario_, "--golden", "yesterday.mcap", "--controller", changed_gain}).status, 1);
}

TEST_F(Check, UnderCiWritesNoGolden) {
  const Outcome outcome = rehearse({"check", scenario_}, "CI=true REHEARSE_GOLDEN=new");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith("error: REHEARSE_GOLDEN is 'new', but CI is 'true'"));
  EXPECT_FALSE(exists(golden_of_robot));
}

TEST_F(Check, OfAControllerThatFailsEndsInStatusThree) {
  EXPECT_EQ(rehearse({"record", pendulum(MISBEHAVING).string(), "-o", "calm.mcap"}).status, 0);
  const Outcome outcome = rehearse({"check", pendulum(MISBEHAVING, "throw 7").string(), "--golden", "calm.mcap"});
  EXPECT_EQ(outcome.status, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("controller 'Pendulum/Swing' threw std::runtime_error"));
  EXPECT_EQ(outcome.err, "") << "it is said once";
}

TEST_F(Golden, ListTellsWhoNamesEachAndWhichNobodyNames) {
  accept_golden();
  for (const char* ending : {".mcap", ".txt"})
    fs::copy_file(folder() / ("golden/Robot.Stands" + std::string(ending)),
                  folder() / ("golden/Robot.Falls" + std::string(ending)));
  const nlohmann::json list = done({"golden", "list", "--json"}).json();
  ASSERT_EQ(list["goldens"].size(), 2u);
  EXPECT_EQ(list["goldens"][0]["name"], "Robot.Falls");
  EXPECT_EQ(list["goldens"][0]["orphan"], true);
  EXPECT_EQ(list["goldens"][1]["name"], "Robot.Stands");
  EXPECT_EQ(list["goldens"][1]["orphan"], false);
  EXPECT_EQ(list["goldens"][1]["problem"], nullptr);
  EXPECT_THAT(list["goldens"][1]["owners"][0].get<std::string>(), HasSubstr("stands.yaml"));
  const std::string text = done({"golden", "list"}).out;
  EXPECT_THAT(text, ContainsRegex("\n  Robot.Falls +[0-9.]+ kB +[0-9-]+ +no test or scenario names it +-\n"));
  EXPECT_THAT(text, ContainsRegex("\n  Robot.Stands +[0-9.]+ kB +[0-9-]+ +in use +.*stands.yaml\n"));
}

TEST_F(Golden, AcceptSaysWhatMoved) {
  accept_golden();
  EXPECT_EQ(rehearse({"check", scenario_, "--controller", changed_gain}).status, 1);
  const Outcome outcome = done({"golden", "accept", "Robot.Stands"});
  EXPECT_THAT(outcome.out, StartsWith("accepted golden/Robot.Stands.mcap\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nthe controller changed: fed with the golden's inputs, RLEG_KNEE/u is beyond "));
  EXPECT_THAT(outcome.out, HasSubstr("look at golden/Robot.Stands.txt and commit both files\n"));
  EXPECT_FALSE(exists(pending_of_robot));
  done({"check", scenario_, "--controller", changed_gain});
}

TEST_F(Golden, AcceptRefusesWhatDoesNotWait) {
  const Outcome outcome = rehearse({"golden", "accept", "Robot.Walks"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("nothing waits to be accepted as 'Robot.Walks'"));
}

TEST_F(Golden, AcceptWritesNothingUnderCi) {
  EXPECT_EQ(rehearse({"check", scenario_}).status, 1);
  const Outcome outcome = rehearse({"golden", "accept", "Robot.Stands"}, "CI=true");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, StartsWith("error: goldens are only checked where CI is 'true'"));
  EXPECT_FALSE(exists(golden_of_robot));
}

TEST_F(Diff, FindsNothingBetweenEqualRuns) {
  done({"record", scenario_, "-o", "a.mcap"});
  const nlohmann::json report = done({"diff", "a.mcap", "a.mcap", "--json"}).json();
  EXPECT_EQ(report["equal"], true);
  EXPECT_EQ(report["first"], nullptr);
  EXPECT_THAT(done({"diff", "a.mcap", "a.mcap"}).out, StartsWith("equal bit for bit: "));
}

TEST_F(Diff, TellsTheFirstDivergenceFirst) {
  record_two();
  const Outcome outcome = rehearse({"diff", "a.mcap", "b.mcap"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.out, StartsWith("differs: SR1/"));
  const nlohmann::json report = rehearse({"diff", "a.mcap", "b.mcap", "--json"}).json();
  EXPECT_EQ(report["within"], false);
  EXPECT_GT(report["first"]["tick"], 0);
  EXPECT_NE(report["first"]["expected"], report["first"]["actual"]);
}

TEST_F(Diff, TakesTolerancesFromAFile) {
  record_two();
  write("loose.yaml", "tolerances:\n  - {channel: \"*\", atol: 1.0e9}\n");
  const nlohmann::json report = done({"diff", "a.mcap", "b.mcap", "--tolerances", "loose.yaml", "--json"}).json();
  EXPECT_EQ(report["within"], true);
  EXPECT_EQ(report["equal"], false);
}

TEST_F(Diff, WarnsOfATolerancesChannelThatNeitherTraceHas) {
  done({"record", scenario_, "-o", "a.mcap"});
  write("loose.yaml", "tolerances:\n  - {channel: \"SR1/*/q\", atol: 1}\n  - {channel: \"SR1/*/qq\", atol: 1}\n");
  const Outcome outcome = done({"diff", "a.mcap", "a.mcap", "--tolerances", "loose.yaml"});
  EXPECT_THAT(outcome.out, StartsWith("equal bit for bit: "));
  EXPECT_THAT(outcome.out, HasSubstr("\n  loose.yaml:3:15: warning: the tolerance of 'SR1/*/qq' applies to nothing"));
  const nlohmann::json report = done({"diff", "a.mcap", "a.mcap", "--tolerances", "loose.yaml", "--json"}).json();
  EXPECT_EQ(report["warnings"].size(), 1u);
}

TEST_F(Diff, TellsAProgramAllThatItTellsAPerson) {
  record_two();
  const nlohmann::json report = rehearse({"diff", "a.mcap", "b.mcap", "--json"}).json();
  EXPECT_EQ(report["agreement"], "beyond");
  EXPECT_EQ(report["explanation"], "controller 'SR1/SR1Minimum'");
  EXPECT_GT(report["first"]["times_tolerance"], 1.0);
  EXPECT_GT(report["worst"]["times_tolerance"], report["first"]["times_tolerance"]);
  EXPECT_EQ(report["first_bit"]["tick"], 0);
  EXPECT_FALSE(report["channels"].empty());
  EXPECT_EQ(report["equal_channels"], nlohmann::json({"/contacts", "/events"}));
  EXPECT_EQ(report["remarks"].size(), 1u);
}

TEST_F(Diff, TellsTheSameWithinTheWidthOfATerminal) {
  record_two();
  std::istringstream lines(rehearse({"diff", "a.mcap", "b.mcap"}).out);
  std::string line;
  int rows = 0;
  std::getline(lines, line);  // the verdict
  for (; std::getline(lines, line) && !line.starts_with("  worst: "); ++rows) {
    const auto inside = std::ranges::count_if(line, [](char c) { return (c & 0xc0) == 0x80; });
    EXPECT_LE(static_cast<std::ptrdiff_t>(line.size()) - inside, 120) << line;
  }
  EXPECT_GT(rows, 8);
}

TEST_F(Diff, TakesTolerancesFromAScenario) {
  record_two();
  EXPECT_EQ(rehearse({"diff", "a.mcap", "b.mcap", "--tolerances", scenario_}).status, 1);
}

TEST_F(Diff, RefusesAFileThatHasNoTolerances) {
  record_two();
  const auto refusal = [this](const std::string& text) {
    const Outcome outcome = rehearse({"diff", "a.mcap", "b.mcap", "--tolerances", write("t.yaml", text).string()});
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  EXPECT_THAT(refusal("tolerance: []\n"), ContainsRegex("t.yaml:1:1: error: .*'tolerance'"));
  EXPECT_THAT(refusal("tolerances: [{channel: x, atol: -1}]\n"), ContainsRegex("t.yaml:1:[0-9]+: error: "));
  EXPECT_THAT(refusal("- 1\n"), HasSubstr("t.yaml:1:1: error: "));
  EXPECT_THAT(refusal("a: [\n"), HasSubstr("t.yaml:"));
}

TEST_F(Golden, AcceptPrintsTheVerdictOfTheCheck) {
  accept_golden();
  EXPECT_EQ(rehearse({"check", scenario_, "--controller", changed_gain}).status, 1);
  EXPECT_THAT(done({"golden", "accept", "Robot.Stands"}).out, HasSubstr("\nthe controller changed: "));
}

}  // namespace
}  // namespace rehearse::test
