// rehearse replay of a robot's log: the log is a golden, which is an ordinary ROS 2 bag.
#include "command.h"
#include "support/files.h"

#include <gmock/gmock.h>
#include <rehearse/mcap.h>
#include <rehearse/trace.h>

#include <algorithm>

#include "core/scenario/trace_scenario.h"

namespace rehearse::test {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class ReplayLog : public Command {
 protected:
  ReplayLog() {
    fs::copy_file(fixtures / "logs/tank.map.yaml", folder() / "tank.map.yaml");
    fs::copy_file(fixtures / "../golden/Tank.IsDrivenByJoystick.mcap", folder() / "tank_log.mcap");
  }

  std::vector<std::string> tank(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"replay",         "tank_log.mcap", "--controller",
                                       "TankController", "--model",       (fixtures / "models/tank.urdf").string(),
                                       "--map",          "tank.map.yaml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(ReplayLog, TellsWhatTheTopicsGaveAndWhetherTheCommandsAreTheSame) {
  const Outcome outcome = done(tank());
  EXPECT_THAT(outcome.out, StartsWith("replayed the log tank_log.mcap: 1001 ticks, 5.005 s, in "));
  EXPECT_THAT(outcome.out, ContainsRegex("/Tank/joints +joints +1001 +200 +1001 "));
  EXPECT_THAT(outcome.out, HasSubstr(" in tank_log.replay.mcap\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nthe log's commands, bit for bit: 1000 ticks, 4000 commanded numbers\n"));
  EXPECT_EQ(outcome.err, "");
}

TEST_F(ReplayLog, TellsHowLongControlTookAndWarnsBeyondADeadline) {
  const Outcome outcome = rehearse(tank({"--deadline", "1e-6"}));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, HasSubstr("\ncontrol() of Tank/TankController: median "));
  EXPECT_THAT(outcome.err, HasSubstr("longer than the deadline of 0.001 µs"));
  EXPECT_EQ(done(tank({"--json"})).json()["control_times"][0]["calls"], 1001);
}

TEST_F(ReplayLog, WritesARecordingThatIsReplayedLikeAnyOther) {
  done(tank({"-o", "run.mcap"}));
  fs::remove(folder() / "tank_log.mcap");
  fs::remove(folder() / "tank.map.yaml");
  EXPECT_THAT(done({"replay", "run.mcap"}).out, HasSubstr("\nequal bit for bit: 1001 ticks, "));
  EXPECT_THAT(done({"info", "run.mcap"}).out, HasSubstr("tank_log.mcap"));
}

TEST_F(ReplayLog, AnswersInJson) {
  const nlohmann::json report = done(tank({"--json"})).json();
  EXPECT_EQ(report["verdict"], "the log's commands, bit for bit: 1000 ticks, 4000 commanded numbers");
  EXPECT_EQ(report["equal"], true);
  EXPECT_EQ(report["within"], true);
  EXPECT_EQ(report["first"], nullptr);
  EXPECT_EQ(report["ticks"], 1001);
  EXPECT_EQ(report["values"], 4000);
  EXPECT_EQ(report["trace"], "tank_log.replay.mcap");
  ASSERT_EQ(report["topics"].size(), 3u);
  EXPECT_EQ(report["topics"][0]["topic"], "/Tank/joints");
  EXPECT_EQ(report["topics"][0]["messages"], 1001);
  EXPECT_EQ(report["topics"][0]["gaps"], 0);
}

TEST_F(ReplayLog, TellsOfTicksAtMessagesAndOfUnknownOnes) {
  std::ofstream(folder() / "tank.map.yaml", std::ios::app) << "\ntick: /Tank/joints\n";
  const Outcome outcome = done(tank());
  EXPECT_THAT(outcome.out, HasSubstr("\nticks: each message on /Tank/joints, 0.005 s apart, 0 missing\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nthe log's commands, bit for bit: 1000 ticks, 4000 commanded numbers\n"));
  const nlohmann::json report = done(tank({"--json"})).json();
  EXPECT_EQ(report["tick"]["topic"], "/Tank/joints");
  EXPECT_EQ(report["tick"]["missing"], 0);
  EXPECT_EQ(report["ticks_unknown"], (nlohmann::json{{"without_message", 0}, {"without_command", 0}, {"in_doubt", 0}}));
}

TEST_F(ReplayLog, EndsIn4IfTheStateOfTheControllerIsUnknown) {
  done({"filter", "tank_log.mcap", "--from", "2", "-o", "late.mcap"});
  fs::rename(folder() / "late.mcap", folder() / "tank_log.mcap");
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nundecided: from 0.000 s on TURRET_"));
  EXPECT_THAT(outcome.out, HasSubstr("the controller has a state that doesn't fade, such as an integral"));
  const nlohmann::json report = rehearse(tank({"--json"})).json();
  EXPECT_EQ(report["undecided"], true);
  EXPECT_EQ(report["within"], false);
  EXPECT_EQ(report["certain"]["ticks"], 0);
  EXPECT_EQ(report["certain"]["memory"], nullptr);
}

TEST_F(ReplayLog, NamesNoTickAsAFindingWhereNothingIsDecided) {
  done({"filter", "tank_log.mcap", "--from", "2", "-o", "late.mcap"});
  fs::rename(folder() / "late.mcap", folder() / "tank_log.mcap");
  const Outcome outcome = rehearse(tank());
  EXPECT_THAT(outcome.out, Not(AnyOf(HasSubstr("\nfirst: "), HasSubstr("\nworst: "))));
  const nlohmann::json report = rehearse(tank({"--json"})).json();
  for (const char* key : {"first", "worst", "beyond"}) EXPECT_EQ(report[key], nullptr) << key;
  EXPECT_EQ(report["ticks_different"], 600);
}

TEST_F(ReplayLog, CountsTimesFromTheLogsBeginningOrTakesDates) {
  done({"filter", "tank_log.mcap", "--from", "2", "-o", "late.mcap", "--topics", "/Tank/*"});
  done({"filter", "tank_log.mcap", "--until", "1", "-o", "early.mcap", "--topics", "/joy"});
  fs::remove(folder() / "tank_log.mcap");
  done({"merge", "early.mcap", "late.mcap", "-o", "tank_log.mcap"});
  const nlohmann::json report = rehearse(tank({"--json", "--until", "3"})).json();
  EXPECT_EQ(report["begins"], 2.0) << "the first tick has joints";
  EXPECT_EQ(report["ticks"], 200);
  const Outcome late = rehearse(tank({"--from", "9"}));
  EXPECT_EQ(late.status, 2);
  EXPECT_THAT(late.err, HasSubstr("nothing was recorded in the span that is asked for"));
  const Outcome early = rehearse(tank({"--until", "1"}));
  EXPECT_EQ(early.status, 2);
  EXPECT_THAT(early.err, HasSubstr("the first tick is 2 s after the log's beginning"));
}

TEST_F(ReplayLog, TakesDatesInItsRecordingToo) {
  done({"filter", "tank_log.mcap", "--exclude", "/tick", "-o", "log.mcap"});
  fs::rename(folder() / "log.mcap", folder() / "tank_log.mcap");
  EXPECT_EQ(rehearse(tank({"--until", "1970-01-01T00:00:02Z", "-o", "run.mcap", "--json"})).json()["ticks"], 400);
  EXPECT_THAT(done({"replay", "run.mcap", "--until", "1970-01-01T00:00:01Z"}).out, HasSubstr(": 200 ticks without"));
  EXPECT_THAT(done({"filter", "run.mcap", "--until", "1970-01-01T00:00:01Z", "-o", "part.mcap"}).out,
              HasSubstr("from 0 s to 0.995"));
  EXPECT_THAT(rehearse({"report", "run.mcap", "--from", "1970-01-01T00:00:03Z"}).err,
              HasSubstr("nothing was recorded"));
  for (const char* verb : {"replay", "step", "report", "filter"}) {
    std::vector<std::string> words{verb, "golden.mcap", "--from", "2026-11-26T12:00:00Z"};
    if (std::string(verb) == "filter") words.insert(words.end(), {"-o", "none.mcap"});
    fs::copy_file(fixtures / "../golden/Tank.IsDrivenByJoystick.mcap", folder() / "golden.mcap",
                  fs::copy_options::overwrite_existing);
    const Outcome refused = rehearse(words);
    EXPECT_EQ(refused.status, 2) << verb;
    EXPECT_THAT(refused.err, HasSubstr("its times count from the beginning of the run, and are no dates")) << verb;
  }
}

/// The controller that the log has didn't start again, so the second part differs.
TEST_F(ReplayLog, StartsAFreshControllerAtEachRestart) {
  std::ofstream(folder() / "tank.map.yaml", std::ios::app) << "\nrestart: 2\n";
  const Outcome outcome = rehearse(tank({"-o", "run.mcap"}));
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nthe log's commands, bit for bit: 400 ticks, 1600 commanded numbers\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nafter the restart at 2.0000 s of the log: 601 ticks, 3.005 s\n"));
  EXPECT_THAT(outcome.out, HasSubstr("at tick 0 (0 s): "));
  EXPECT_THAT(outcome.out, HasSubstr(", at 2.0000 s of the log; it is the first of 600 ticks that differ"));
  EXPECT_THAT(done({"replay", "run.2.mcap"}).out, HasSubstr("\nequal bit for bit: 601 ticks, "));
  const nlohmann::json report = rehearse(tank({"-o", "run.mcap", "--json"})).json();
  ASSERT_EQ(report["after_restarts"].size(), 1);
  EXPECT_EQ(report["after_restarts"][0]["begins"], 2.0);
  EXPECT_EQ(report["after_restarts"][0]["trace"], "run.2.mcap");
  std::ofstream(folder() / "run.2.mcap") << "notes";
  EXPECT_THAT(rehearse(tank({"-o", "run.mcap"})).err, HasSubstr("run.2.mcap"));
  EXPECT_EQ(read_file(folder() / "run.2.mcap"), "notes");
}

/// Commands of a robot's log are judged by their range, also when its recording is compared.
TEST_F(ReplayLog, StatesTheTolerancesOfTheLogInItsRecording) {
  done(tank({"-o", "run.mcap"}));
  const auto run = mcap::Reader::open(folder() / "run.mcap");
  ASSERT_TRUE(run.ok());
  const auto scenario = scenario_of(**run);
  ASSERT_TRUE(scenario.ok());
  const std::vector<ToleranceRule>& rules = scenario->tolerances;
  const auto of_turret = std::ranges::find_if(
      rules, [](const ToleranceRule& rule) { return rule.channel == "Tank/TankController/output/TURRET_P/u"; });
  ASSERT_NE(of_turret, rules.end());
  EXPECT_NEAR(*of_turret->atol, 2.514e-5, 1e-8) << "1e-4 of its range of 0.25 N·m";
}

TEST_F(ReplayLog, EndsIn1IfTheCommandsDiffer) {
  // half a second late, the joystick has a different reading
  std::ofstream(folder() / "tank.map.yaml") << "rehearse_map: 1\ntime_step: 0.005\nbody: Tank\njoints: /Tank/joints\n"
                                               "joystick: /joy\nbegins: controller\n"
                                               "commands: {topic: /Tank/Driver/output/joints, shift: 100}\n";
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("differs from the log's commands at tick "), HasSubstr("\nworst: ")));
}

TEST_F(ReplayLog, NamesTheTimeIfTheCommandsAgreeATickLater) {
  std::ofstream(folder() / "tank.map.yaml") << "rehearse_map: 1\ntime_step: 0.005\nbody: Tank\njoints: /Tank/joints\n"
                                               "joystick: /joy\n"
                                               "commands: {topic: /Tank/Driver/output/joints, shift: -1}\n";
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nthe time differs: the commands agree in 999 of 999 ticks if taken 1 tick later "
                                     "(increase the map's shift by 1); differs from the log's commands at tick "));
  const nlohmann::json report = rehearse(tank({"--json"})).json();
  EXPECT_EQ(report["timing"], (nlohmann::json{{"shift", 1}, {"ticks", 999}, {"different", 0}}));
  EXPECT_EQ(report["cause"], nullptr);
}

TEST_F(ReplayLog, NamesTheLinesOfTheMapWithWhichTheCommandsAgree) {
  std::ofstream(folder() / "tank.map.yaml") << "rehearse_map: 1\ntime_step: 0.0025\nbody: Tank\njoints: /Tank/joints\n"
                                               "joystick: /joy\ncommands: /Tank/Driver/output/joints\n";
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  EXPECT_THAT(outcome.out,
              HasSubstr(" ticks with tick: /Tank/joints and time_step: 0.005 in the map: the controller is "
                        "called at each message on /Tank/joints; as the map is, "));
  const std::string verdict = outcome.out.substr(outcome.out.find("\nundecided: "));  // control()'s longest has a tick
  EXPECT_THAT(verdict, Not(AnyOf(HasSubstr("\nfirst: "), HasSubstr("\nworst: "), HasSubstr("at tick "))));
  const nlohmann::json report = rehearse(tank({"--json"})).json();
  EXPECT_EQ(report["cause"]["lines"], (nlohmann::json{"tick: /Tank/joints", "time_step: 0.005"}));
  EXPECT_EQ(report["cause"]["different"], 0);
  EXPECT_EQ(report["undecided"], true);
}

TEST_F(ReplayLog, IsUndecidedAboutCommandsWithoutInputs) {
  done({"filter", "tank_log.mcap", "--until", "2", "-o", "inputs.mcap"});
  done({"filter", "tank_log.mcap", "--from", "2", "-o", "later.mcap", "--topics", "/Tank/Driver/output/joints"});
  fs::remove(folder() / "tank_log.mcap");
  done({"merge", "inputs.mcap", "later.mcap", "-o", "tank_log.mcap"});
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 4) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nundecided: for 600 ticks of commands after 1.995 s the log has no inputs; the "
                                     "commands before agree: 400 ticks, 1600 commanded numbers\n"));
  const nlohmann::json report = rehearse(tank({"--json"})).json();
  EXPECT_EQ(report["ticks_without_inputs"], 600);
  EXPECT_EQ(report["equal"], false);
  EXPECT_EQ(report["within"], false);
}

TEST_F(ReplayLog, WritesAScenarioThatBeginsAsTheLogDid) {
  done(tank({"--scenario", "monday.yaml"}));
  const std::string text = read_file(folder() / "monday.yaml");
  EXPECT_THAT(text, StartsWith("# Begins as the log tank_log.mcap: the posture of its first tick, its joystick.\n"));
  EXPECT_THAT(text, HasSubstr("pushes"));
  EXPECT_THAT(done({"record", "monday.yaml", "-o", "monday.mcap", "--duration", "0.1"}).err, Not(HasSubstr("error")));
  const auto begin = Trace::load(folder() / "monday.mcap"), log = Trace::load(folder() / "tank_log.mcap");
  ASSERT_TRUE(begin.ok() && log.ok());
  for (const char* joint : {"TURRET_Y", "TURRET_P"})
    EXPECT_NEAR(begin->first("Tank/" + std::string(joint) + "/q"), log->first("Tank/" + std::string(joint) + "/q"),
                1e-9);
  const Outcome again = rehearse(tank({"--scenario", "monday.yaml"}));
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("there is a file monday.yaml already"));
}

TEST_F(ReplayLog, EndsIn2IfNothingWasCompared) {
  // later than the log is long
  std::ofstream(folder() / "tank.map.yaml") << "rehearse_map: 1\ntime_step: 0.005\nbody: Tank\njoints: /Tank/joints\n"
                                               "joystick: /joy\n"
                                               "commands: {topic: /Tank/Driver/output/joints, shift: 1000}\n";
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 2) << outcome.out;
  EXPECT_THAT(outcome.out, HasSubstr("nothing was compared"));
  const nlohmann::json report = rehearse(tank({"--json"})).json();
  EXPECT_EQ(report["equal"], false);
  EXPECT_EQ(report["within"], false);
}

TEST_F(ReplayLog, BecomesAGoldenThatCheckKnows) {
  fs::create_directory(folder() / "golden");
  done(tank({"-o", "run.mcap"}));
  fs::create_directory(folder() / "pending");
  fs::rename(folder() / "run.mcap", folder() / "pending/Tank.DrivesAsInTheLog.mcap");
  const std::string environment = "REHEARSE_PENDING=pending";
  const Outcome accepted = run(command, {"golden", "accept", "Tank.DrivesAsInTheLog"}, environment);
  EXPECT_EQ(accepted.status, 0) << accepted.err;
  EXPECT_TRUE(fs::exists(folder() / "golden/Tank.DrivesAsInTheLog.txt"));
  const Outcome checked = run(command, {"check", "golden/Tank.DrivesAsInTheLog.mcap"}, environment);
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("controller: equal; plant: not compared; closed: not compared"));
  EXPECT_THAT(checked.out, HasSubstr("recorded from a log: there is no physics to repeat"));
  const Outcome replayed = done({"replay", "golden/Tank.DrivesAsInTheLog.mcap"});
  EXPECT_THAT(replayed.out, HasSubstr("\nequal bit for bit: "));
}

TEST_F(ReplayLog, CheckRefusesOtherRecordings) {
  const Outcome outcome = rehearse({"check", "tank_log.mcap"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("tank_log.mcap: error: it isn't a recording of a robot's log"));
}

TEST_F(ReplayLog, NeedsALibraryAModelAndAMap) {
  const auto refused = [this](const std::vector<std::string>& arguments) {
    const Outcome outcome = rehearse(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    return outcome.err;
  };
  EXPECT_THAT(refused({"replay", "tank_log.mcap", "--controller", "TankController"}),
              HasSubstr("'TankController' is not NAME=LIB"));
  EXPECT_THAT(refused({"replay", "tank_log.mcap", "--model", "tank.urdf"}), HasSubstr("--model without --map"));
  EXPECT_THAT(refused({"replay", "tank_log.mcap", "--map", "tank.map.yaml"}), HasSubstr("--map without --model"));
  EXPECT_THAT(refused({"replay", "tank_log.mcap", "--map", "tank.map.yaml", "--model", "tank.urdf"}),
              HasSubstr("expected --controller LIB"));
  EXPECT_THAT(refused(tank({"-o", "tank.map.yaml"})), HasSubstr("tank.map.yaml"));
}

TEST_F(ReplayLog, TellsTheMistakesOfAMapWithTheirPlaces) {
  std::ofstream(folder() / "tank.map.yaml") << "rehearse_map: 1\ntime_step: 0.005\njoints: /Tank/joint\n"
                                               "cameras: {topic: /joy, device: Eye}\n";
  const Outcome outcome = rehearse(tank());
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("tank.map.yaml:3:9: error: the log has no topic '/Tank/joint' (did you mean "
                                     "'/Tank/joints'?)\n"));
  EXPECT_THAT(outcome.err, HasSubstr("tank.map.yaml:4:18: error: '/joy' is of type sensor_msgs/msg/Joy, which isn't an "
                                     "Image or CompressedImage"));
}

}  // namespace
}  // namespace rehearse::test
