// The sentence of a verdict names the cause that explains the difference, and blames nobody whom another cause
// explains.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "core/guard/own_process.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/key_changes.h"
#include "core/scenario/structure_change.h"
#include "mutilate.h"
#include "standing_robot.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Blamed : public ::testing::Test {
 protected:
  CheckReport checked(const CheckOptions& options = {}) const {
    auto report = robot_.check(options);
    EXPECT_TRUE(report.ok()) << to_string(report.errors());
    return report ? *std::move(report) : CheckReport();
  }
  /// A check with another library of the controller.
  CheckReport checked_with(const std::string& library, CheckOptions options = {}) const {
    options.run.libraries["Stand"] = library;
    return checked(options);
  }

  StandingRobot robot_;
};

/// A controller may read more without commanding otherwise.
TEST_F(Blamed, NobodyIfAControllerReadsOtherInputsAndCommandsTheSame) {
  robot_.record_golden();
  const CheckReport more = checked_with("StandWith_more_sensors");
  EXPECT_TRUE(more.equal()) << more.verdict.text();
  EXPECT_THAT(more.verdict.text(),
              StartsWith("the controller reads other inputs: + /SR1/Stand/input/WAIST/pose, + SR1/"));

  RecordOptions original;
  original.libraries["Stand"] = "StandWith_more_sensors";
  robot_.record_golden(original);
  const CheckReport fewer = checked();
  EXPECT_TRUE(fewer.equal()) << fewer.verdict.text();
  EXPECT_THAT(fewer.verdict.text(),
              StartsWith("the controller reads other inputs: - /SR1/Stand/input/WAIST/pose, - SR1/"));
}

/// A joint's effort is one more column of a channel, and is no number for the other joints.
TEST_F(Blamed, NobodyIfAControllerReadsMoreOfAJointAndCommandsTheSame) {
  robot_.record_golden();
  CheckOptions closed;
  closed.controller = closed.plant = false;
  for (const CheckOptions& levels : {CheckOptions(), closed}) {
    const CheckReport more = checked_with("StandWith_more_joints", levels);
    EXPECT_TRUE(more.equal()) << more.verdict.text();
    EXPECT_THAT(more.verdict.text(),
                StartsWith("the controller reads other inputs: + RLEG_KNEE/u of SR1/Stand; equal bit for bit"));
  }

  RecordOptions original;
  original.libraries["Stand"] = "StandWith_more_joints";
  robot_.record_golden(original);
  const CheckReport fewer = checked();
  EXPECT_TRUE(fewer.equal()) << fewer.verdict.text();
  EXPECT_THAT(fewer.verdict.text(), StartsWith("the controller reads other inputs: - RLEG_KNEE/u of SR1/Stand; equal"));
}

TEST_F(Blamed, ADelayThatChangesDuringTheRunIsTheControllers) {
  RecordOptions original;
  original.libraries["Stand"] = "StandWith_no_delay_later";
  robot_.record_golden(original);
  const CheckReport same = checked_with("StandWith_no_delay_later");
  EXPECT_TRUE(same.equal()) << same.verdict.text();
  const CheckReport other = checked();
  EXPECT_EQ(other.plant, LevelState::equal);
  EXPECT_THAT(other.verdict.text(),
              StartsWith("the controller changed: fed with the golden's inputs, it differs at tick 300"));
  EXPECT_THAT(other.verdict.text(), HasSubstr("it has left the no-delay mode"));
}

TEST_F(Blamed, WordsThatDifferEarlierComeFirst) {
  robot_.record_golden();
  EXPECT_THAT(
      checked_with("StandWith_announced").verdict.text(),
      StartsWith("the controller changed: at tick 499 (0.499 s), before its commands differ, this line is extra: "
                 "\"SR1/Stand: a stiffer knee\"; fed with the golden's inputs, RLEG_KNEE/u is beyond ±0.001 N·m from "
                 "tick 500"));
}

/// The third run of a process is the replay of a check, after the golden's run and the closed loop. With a supervisor the
/// two of the check have processes of their own, so that neither is the third.
TEST_F(Blamed, NoLibraryForDataOfAnEarlierRun) {
  CheckOptions options;
  options.run.keep_libraries = true;
  RecordOptions original;
  original.keep_libraries = true;
  original.libraries["Stand"] = "StandWith_earlier_runs";
  robot_.record_golden(original);
  const CheckReport report = checked_with("StandWith_earlier_runs", options);
  if (has_own_processes()) {
    EXPECT_TRUE(report.equal()) << report.verdict.text();
    return;
  }
  EXPECT_THAT(report.verdict.text(), StartsWith("an earlier run left data behind"));
  EXPECT_THAT(report.verdict.text(), HasSubstr("`rehearse audit`"));
}

TEST_F(Blamed, NoNewLibraryThatDoesntRepeatItself) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer fills memory with constants";
#endif
  robot_.record_golden();
  const CheckReport report = checked_with("StandWith_uninitialised");
  EXPECT_THAT(
      report.verdict.text(),
      StartsWith("the controller depends on something besides its recorded inputs: two replays of the golden differ"));
}

TEST_F(Blamed, TheScenarioIfItsStructureChanged) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "library: StandWith_none", "library: StandWith_none, delay: false"});
  const CheckReport delay = checked();
  EXPECT_THAT(delay.verdict.text(),
              StartsWith("the scenario changed: line 19: delay of controller 'SR1/Stand' is false, and "
                         "was true; the run differs"));
  EXPECT_EQ(delay.first->stage, Stage::controller);
}

TEST_F(Blamed, TheScenarioIfItHasAnotherBody) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "  - name: Watcher",
                "  - name: Ball\n    sphere: {radius: 0.1}\n    mass: 1\n    "
                "position: [3, 3, 1]\n  - name: Watcher"});
  EXPECT_THAT(checked().verdict.text(), StartsWith("the scenario changed: line 10: body 'Ball' is new"));
}

TEST_F(Blamed, TheScenarioIfABodyHasAnotherName) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "  - name: Floor", "  - name: Ground"});
  EXPECT_THAT(checked().verdict.text(), StartsWith("the scenario changed: line 6: body 'Ground' was named 'Floor'"));
}

TEST(StructureChange, IsTheFirstOfBodiesControllersAndTheirFlags) {
  const std::string before =
      "bodies:\n- {name: A, controllers: [{name: C, library: L, children: [{name: D}]}]}\n"
      "- {name: B}\n";
  EXPECT_EQ(structure_change(before, before), "");
  const auto change = [&](const std::string& from, const std::string& to) {
    std::string now = before;
    return structure_change(before, now.replace(now.find(from), from.size(), to));
  };
  EXPECT_EQ(change("library: L", "library: M"), "") << "libraries are compared by their content";
  EXPECT_EQ(change("library: L", "optional: true"), "line 2: optional of controller 'A/C' is true, and was false");
  EXPECT_EQ(change("library: L", "delay: true"), "");
  EXPECT_EQ(change("name: D", "name: E"), "line 2: controller of body 'A': 'E' was named 'D'");
  EXPECT_EQ(change("- {name: B}", ""), "body 'B' is gone");
  EXPECT_EQ(change("- {name: B}", "- {name: B}\n- {name: E}"), "line 4: body 'E' is new");
  EXPECT_EQ(structure_change("bodies: [{name: A, controllers: [{library: ../lib/Hold.so}]}]",
                             "bodies: [{name: A, controllers: [{library: Hold, delay: false}]}]"),
            "line 1: delay of controller 'A/Hold' is false, and was true");
  EXPECT_EQ(structure_change("bodies: [{name: A}, {name: B}]", "bodies: [{name: B}, {name: A}]"), "");
  EXPECT_EQ(structure_change("[", before), "");
}

TEST_F(Blamed, AModelWithAnotherJointComesBeforeItsConsequences) {
  robot_.record_golden();
  robot_.apply({"sr1.urdf", "name=\"WAIST_P\"", "name=\"WAIST_PITCH\""});
  const CheckReport renamed = checked();
  EXPECT_FALSE(renamed.within());
  EXPECT_THAT(renamed.verdict.text(), StartsWith("the model of 'SR1' changed: "));
  EXPECT_THAT(renamed.verdict.text(), HasSubstr("'WAIST_PITCH' was named 'WAIST_P'; the run differs"));
}

/// The commands of a controller that computes otherwise must have the golden's bits, but it is no news that they are
/// within tolerance.
TEST_F(Blamed, AControllerWhoseCommandsAreWithinToleranceIsToldSo) {
  robot_.write("scenario.yaml", std::string(standing_yaml) + "tolerances:\n  - {channel: '*', atol: 1000}\n");
  robot_.record_golden();
  const CheckReport gain = checked_with("StandWith_gain");
  EXPECT_EQ(gain.controller, LevelState::differs);
  EXPECT_EQ(gain.closed, LevelState::within);
  EXPECT_THAT(gain.verdict.text(),
              StartsWith("the controller changed: fed with the golden's inputs, commands change within tolerance from "
                         "tick 0 (0 s) on: worst RLEG_KNEE/u, off by "));
  EXPECT_THAT(gain.verdict.text(), HasSubstr("; the run stays within its tolerances"));
  ASSERT_TRUE(gain.first);
  EXPECT_FALSE(gain.first->is_beyond());
}

/// A small change of commands moves the robot by many times the tolerances of positions.
TEST_F(Blamed, AControllerWhoseCommandsAreWithinToleranceAndWhoseRunIsNot) {
  robot_.write("scenario.yaml",
               std::string(standing_yaml) +
                   "tolerances:\n  - {channel: '*', atol: 1000}\n  - {channel: 'SR1/*/q', atol: 1e-9}\n");
  robot_.record_golden();
  const CheckReport gain = checked_with("StandWith_gain");
  const std::string said = gain.verdict.text();
  EXPECT_THAT(said, HasSubstr("commands change within tolerance"));
  EXPECT_THAT(said, Not(HasSubstr("only bits differ")));
  ASSERT_TRUE(gain.comparison && gain.comparison->first);
  const Divergence& first = *gain.comparison->first;
  EXPECT_THAT(
      said, HasSubstr(fmt::format("; the run leaves its own: {} is beyond ±{:g} {} from tick {} ",
                                  series_name(first.channel, first.element), first.tolerance, first.unit, first.tick)));
}

/// A command that comes a tick later is as large as before: its distance from the golden's values within lag is none.
TEST_F(Blamed, AControllerThatIsLateWithinItsLagIsToldByHowMuchItsCommandsDiffer) {
  robot_.write("scenario.yaml",
               std::string(standing_yaml) + "tolerances:\n  - {channel: '*', atol: 0.001, lag: 0.002}\n");
  robot_.record_golden();
  const CheckReport late = checked_with("StandWith_late");
  EXPECT_EQ(late.controller, LevelState::differs);
  ASSERT_TRUE(late.replay && late.replay->largest);
  EXPECT_GT(late.replay->largest->difference, 1.0);
  EXPECT_THAT(late.verdict.text(),
              HasSubstr(fmt::format("off by {:.3g} N·m and within lead and lag at tick {}",
                                    late.replay->largest->difference, late.replay->largest->tick)));
}

/// One rounding more in each command: the difference is measured.
TEST_F(Blamed, ADifferenceOfRoundingIsCalledOne) {
  robot_.write("scenario.yaml", std::string(standing_yaml) + "tolerances:\n  - {channel: '*', atol: 1000}\n");
  robot_.record_golden();
  const CheckReport rounding = checked_with("StandWith_rounding");
  ASSERT_TRUE(rounding.replay);
  EXPECT_GT(rounding.replay->most_ulps, 0u);
  EXPECT_LT(rounding.replay->most_ulps, 10u);
  EXPECT_THAT(rounding.verdict.text(), HasSubstr("fed with the golden's inputs, only bits differ, by up to "));
}

/// The last bit of a magnetometer is within the default tolerance of T. With a rule of 0 it turns a check red, and is
/// called rounding.
TEST_F(Blamed, NobodyForTheLastBitOfOneSensor) {
  const std::string exact = "tolerances:\n  - {channel: 'SR1/Mag/*', atol: 0}\n";
  robot_.apply({"sr1.urdf", "</robot>",
                "<gazebo reference=\"WAIST\"><sensor name=\"Mag\" type=\"magnetometer\"/></gazebo></robot>"});
  robot_.record_golden();
  const auto round = [](const mcap::Message& message) -> std::optional<std::vector<std::byte>> {
    std::vector<std::byte> payload = *testing::untouched(message);
    constexpr std::size_t after_z = 10 * sizeof(double);  // z itself and nine numbers of the covariance
    if (message.channel->topic == "/SR1/Mag/magnetic_field" && message.log_time == 300'000'000)
      payload[payload.size() - after_z] ^= std::byte{1};
    return payload;
  };
  ASSERT_TRUE(testing::mutilate(robot_.file("golden.mcap"), round));
  EXPECT_THAT(checked().verdict.text(), HasSubstr("this run is within its tolerances"));
  robot_.write("scenario.yaml", standing_yaml + exact);
  const CheckReport report = checked();
  EXPECT_EQ(report.verdict.code(), "sensors.changed");
  EXPECT_THAT(report.verdict.text(), StartsWith("under the golden's commands, only rounding differs: SR1/Mag/"));
  EXPECT_THAT(report.verdict.text(), HasSubstr(" T (1 ULP) at tick 300, and no tolerance covers it"));
}

/// A rule that is written for commands counts on the golden's inputs; another one doesn't.
TEST_F(Blamed, NobodyIfARuleForCommandsAllowsTheirDifference) {
  const auto check_with_rule = [&](const std::string& pattern) {
    robot_.write("scenario.yaml", std::string(standing_yaml) + "tolerances:\n  - {channel: '*', atol: 1000}\n" +
                                      "  - {channel: '" + pattern + "', atol: 1000, lag: 0.002}\n");
    robot_.record_golden();
    return checked_with("StandWith_gain");
  };
  EXPECT_TRUE(check_with_rule("SR1/*/u").within());
  const CheckReport allowed = check_with_rule("SR1/Stand/output/*");
  EXPECT_EQ(allowed.controller, LevelState::within) << allowed.verdict.text();
  EXPECT_TRUE(allowed.within());
  EXPECT_FALSE(allowed.equal());
  EXPECT_THAT(allowed.remarks,
              ::testing::Contains(StartsWith("the rules for commands allow the differences: fed with "
                                             "the golden's inputs, commands change within tolerance")));
  EXPECT_FALSE(check_with_rule("SR1/*").within());
}

/// What a run has beside the golden's channels is no reason to hide the first number.
TEST_F(Blamed, TheFirstNumberLeadsBeforeAChannelThatOnlyTheRunHas) {
  robot_.record_golden();
  robot_.apply(
      {"scenario.yaml", "    controllers:", "    actuators: [{joint: RLEG_KNEE, stiction: 5}]\n    controllers:"});
  const CheckReport report = checked();
  EXPECT_FALSE(report.within());
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->note, "") << to_string(*report.first);
  EXPECT_THAT(report.verdict.text(), HasSubstr("scenario.yaml:19 (bodies/SR1/actuators is new)"));
  EXPECT_THAT(report.comparison->remarks,
              ::testing::Contains(HasSubstr("/SR1/actuators: the channel is not in the golden")));
}

/// The controller's own file is the recorded one; a library that it links isn't.
TEST_F(Blamed, ALibraryThatTheControllerLinks) {
  namespace fs = std::filesystem;
  const auto link_with = [&](const char* library) {
    fs::copy_file(library, robot_.file("new.so"));
    fs::rename(robot_.file("new.so"), robot_.file("libstrength.so"));  // the old one may be mapped
  };
  fs::copy_file(VERDICT_CONTROLLERS "/Linked.so", robot_.file("Linked.so"));
  link_with(STRENGTH_1);
  RecordOptions original;
  original.libraries["Stand"] = robot_.file("Linked.so");
  robot_.record_golden(original);
  EXPECT_TRUE(checked_with(robot_.file("Linked.so")).equal());
  link_with(STRENGTH_2);
  const CheckReport report = checked_with(robot_.file("Linked.so"));
  EXPECT_EQ(report.verdict.code(), "controller.surroundings_changed");
  EXPECT_THAT(report.verdict.text(),
              StartsWith("SR1/Stand: the library libstrength.so has changed since the recording: the controller is the "
                         "recorded one"));
}

TEST(KeyChanges, NameTheKeyItsLineAndBothValues) {
  const auto change = [](const std::string& before, const std::string& now) {
    std::vector<std::string> texts;
    for (const KeyChange& one : key_changes(before, now)) texts.push_back(to_string(one, "f"));
    return fmt::format("{}", fmt::join(texts, "; "));
  };
  const std::string yaml = "gravity: [0, 0, -9.8]\nbodies:\n  - {name: A, mass: 1}\n  - {name: B, mass: 2}\n";
  EXPECT_EQ(change(yaml, yaml), "");
  EXPECT_EQ(change(yaml, "# a remark\nbodies: [{mass: 1.0, name: A}, {name: B, mass: 2}]\ngravity: [0, 0, -9.8]\n"),
            "");
  EXPECT_EQ(change(yaml, "gravity: [0, 0, -9]\nbodies:\n  - {name: A, mass: 1}\n  - {name: B, mass: 3}\n"),
            "f:1 (gravity is [0, 0, -9], was [0, 0, -9.8]); f:4 (bodies/B/mass is 3, was 2)");
  EXPECT_EQ(change("a: 1\nexpect: [x]\n", "b: 1\ntolerances: [y]\n"), "f:1 (b is 1, and is new); f (a is gone, was 1)");
  const std::string xml = "<robot><link name=\"L\"><visual/><visual><origin xyz=\"0 0 1\"/></visual></link></robot>";
  EXPECT_EQ(change(xml, xml), "");
  EXPECT_EQ(change(xml, "\n<robot>\n<link name=\"L\"><visual/><visual><origin xyz=\"0 0 2\"/></visual></link></robot>"),
            "f:3 (link L/visual 2/origin/xyz is 0 0 2, was 0 0 1)");
  EXPECT_EQ(change("[", yaml), "");
  EXPECT_EQ(change(yaml, "<robot"), "");
}

TEST_F(Blamed, NobodyByALevelThatComparedNothing) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "duration: 0.6", "duration: 0.6\ntime_step: 0.002"});
  const CheckReport other = checked();
  EXPECT_FALSE(other.within());
  EXPECT_EQ(levels_text(other), "controller: not compared; plant: not compared; closed: not compared");
}

}  // namespace
}  // namespace rehearse
