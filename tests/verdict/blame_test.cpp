// The sentence of a verdict names the cause that explains the difference, and blames nobody whom another cause
// explains.
#include <gmock/gmock.h>

#include "core/scenario/structure_change.h"
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
  EXPECT_TRUE(more.equal()) << more.verdict;
  EXPECT_THAT(more.verdict, StartsWith("the controller reads other inputs: + /SR1/Stand/input/WAIST/pose, + SR1/"));

  RecordOptions original;
  original.libraries["Stand"] = "StandWith_more_sensors";
  robot_.record_golden(original);
  const CheckReport fewer = checked();
  EXPECT_TRUE(fewer.equal()) << fewer.verdict;
  EXPECT_THAT(fewer.verdict, StartsWith("the controller reads other inputs: - /SR1/Stand/input/WAIST/pose, - SR1/"));
}

/// A joint's effort is one more column of a channel, and is no number for the other joints.
TEST_F(Blamed, NobodyIfAControllerReadsMoreOfAJointAndCommandsTheSame) {
  robot_.record_golden();
  CheckOptions closed;
  closed.controller = closed.plant = false;
  for (const CheckOptions& levels : {CheckOptions(), closed}) {
    const CheckReport more = checked_with("StandWith_more_joints", levels);
    EXPECT_TRUE(more.equal()) << more.verdict;
    EXPECT_THAT(more.verdict,
                StartsWith("the controller reads other inputs: + RLEG_KNEE/u of SR1/Stand; equal bit for bit"));
  }

  RecordOptions original;
  original.libraries["Stand"] = "StandWith_more_joints";
  robot_.record_golden(original);
  const CheckReport fewer = checked();
  EXPECT_TRUE(fewer.equal()) << fewer.verdict;
  EXPECT_THAT(fewer.verdict, StartsWith("the controller reads other inputs: - RLEG_KNEE/u of SR1/Stand; equal"));
}

TEST_F(Blamed, ADelayThatChangesDuringTheRunIsTheControllers) {
  RecordOptions original;
  original.libraries["Stand"] = "StandWith_no_delay_later";
  robot_.record_golden(original);
  const CheckReport same = checked_with("StandWith_no_delay_later");
  EXPECT_TRUE(same.equal()) << same.verdict;
  const CheckReport other = checked();
  EXPECT_EQ(other.plant, LevelState::equal);
  EXPECT_THAT(other.verdict,
              StartsWith("the controller changed: fed with the golden's inputs, it differs at tick 300"));
  EXPECT_THAT(other.verdict, HasSubstr("it has left the no-delay mode"));
}

TEST_F(Blamed, WordsThatDifferEarlierComeFirst) {
  robot_.record_golden();
  EXPECT_THAT(
      checked_with("StandWith_announced").verdict,
      StartsWith("the controller changed: at tick 499 (0.499 s), before its commands differ, this line is extra: "
                 "\"SR1/Stand: a stiffer knee\"; RLEG_KNEE/u is beyond ±0.001 N·m from tick 500"));
}

/// The third run of a process is the replay of a check, after the golden's run and the closed loop.
TEST_F(Blamed, NoLibraryForDataOfAnEarlierRun) {
  CheckOptions options;
  options.run.keep_libraries = true;
  RecordOptions original;
  original.keep_libraries = true;
  original.libraries["Stand"] = "StandWith_earlier_runs";
  robot_.record_golden(original);
  const CheckReport report = checked_with("StandWith_earlier_runs", options);
  EXPECT_THAT(report.verdict, StartsWith("an earlier run left data behind"));
  EXPECT_THAT(report.verdict, HasSubstr("`rehearse audit`"));
}

TEST_F(Blamed, NoNewLibraryThatDoesntRepeatItself) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "AddressSanitizer fills memory with constants";
#endif
  robot_.record_golden();
  const CheckReport report = checked_with("StandWith_uninitialised");
  EXPECT_THAT(
      report.verdict,
      StartsWith("the controller depends on something besides its recorded inputs: two replays of the golden differ"));
}

TEST_F(Blamed, TheScenarioIfItsStructureChanged) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "library: StandWith_none", "library: StandWith_none, delay: false"});
  const CheckReport delay = checked();
  EXPECT_THAT(delay.verdict, StartsWith("the scenario changed: line 19: delay of controller 'SR1/Stand' is false, and "
                                        "was true; the run differs"));
  EXPECT_EQ(delay.first->stage, Stage::controller);
}

TEST_F(Blamed, TheScenarioIfItHasAnotherBody) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "  - name: Watcher",
                "  - name: Ball\n    sphere: {radius: 0.1}\n    mass: 1\n    "
                "position: [3, 3, 1]\n  - name: Watcher"});
  EXPECT_THAT(checked().verdict, StartsWith("the scenario changed: line 10: body 'Ball' is new"));
}

TEST_F(Blamed, TheScenarioIfABodyHasAnotherName) {
  robot_.record_golden();
  robot_.apply({"scenario.yaml", "  - name: Floor", "  - name: Ground"});
  EXPECT_THAT(checked().verdict, StartsWith("the scenario changed: line 6: body 'Ground' was named 'Floor'"));
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
  EXPECT_THAT(renamed.verdict, StartsWith("the model of 'SR1' changed: "));
  EXPECT_THAT(renamed.verdict, HasSubstr("'WAIST_PITCH' was named 'WAIST_P'; the run differs"));
}

/// The commands of a controller that computes otherwise must have the golden's bits, but it is no news that they are
/// within tolerance.
TEST_F(Blamed, AControllerWhoseBitsAloneDifferIsToldSo) {
  robot_.write("scenario.yaml", std::string(standing_yaml) + "tolerances:\n  - {channel: '*', atol: 1000}\n");
  robot_.record_golden();
  const CheckReport gain = checked_with("StandWith_gain");
  EXPECT_EQ(gain.controller, LevelState::differs);
  EXPECT_EQ(gain.closed, LevelState::within);
  EXPECT_THAT(gain.verdict,
              StartsWith("the controller changed: only bits differ, from tick 0 (0 s) on; all commands are "
                         "within tolerance: the worst is "));
  ASSERT_TRUE(gain.first);
  EXPECT_FALSE(gain.first->is_beyond());
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
