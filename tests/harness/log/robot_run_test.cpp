// Logs as robots make them: the replay equals the robot's commands wherever the log has the inputs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <tuple>

#include "robot_run.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

using namespace robot_run;
using ::testing::HasSubstr;

#ifdef __SANITIZE_ADDRESS__
constexpr int logs = 4;  // each takes six times as long; four have each robot with each drift
#else
constexpr int logs = LOGS;  // at least five have each robot with each drift
#endif

class ManyLogs : public RobotRunLog, public ::testing::WithParamInterface<int> {};

TEST_P(ManyLogs, EqualTheRobotsCommandsWhereTheLogHasTheirInputs) {
  const int seed = GetParam();
  const Robot robot = seed % 2 == 0 ? walker() : tank();
  LogFaults faults = real;
  if (seed % 4 >= 2) faults.drift = -faults.drift;
  const RobotRun run = robot.run(static_cast<std::uint64_t>(seed), faults, 2000);
  write(run);
  const auto report = replay(robot, by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->ticks_different, 0) << to_string(report->first.value_or(Divergence()));
  EXPECT_TRUE(report->equal());
  const std::int64_t knowable = run.knowable(!robot.has_joystick());
  EXPECT_GT(knowable, 1700);
  EXPECT_GE(report->ticks_compared, knowable) << "what can be known is compared";
  EXPECT_GT(report->ticks_without_command, 0);
  EXPECT_GT(report->tick->missing, 0);
  EXPECT_NEAR(static_cast<double>(report->ticks), 2000.0, 3.0) << "the time of the recording is the robot's";
  EXPECT_NEAR(report->tick->interval, 0.002, 0.00006);
  EXPECT_NEAR(report->tick->latency.value_or(0.0), 0.0005, 0.0001);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ManyLogs, ::testing::Range(0, logs));

/// Another form of a map's ticks and clocks.
struct Form {
  const char* name;
  bool by_timer;
  const char* lines;
  std::int64_t stamp_offset = 0;  // of the joint messages [ns]
  double stamp_drift = 0.0;
};

constexpr Form forms[] = {
    {"at_commands", false, "commands: /joint_commands\ntick: {topic: /joint_commands, latency: measured}\n"},
    {"grid_of_inputs", false, "commands: /joint_commands\ntick: {topic: /joint_states, grid: true}\n"},
    {"timer_at_commands", true, "commands: /joint_commands\ntick: {topic: /joint_commands, latency: measured}\n"},
    {"timer_grid", true, "commands: /joint_commands\ntick: {topic: /joint_commands, grid: true}\n"},
    {"timer_grid_stated", true,
     "commands: /joint_commands\ntick: {topic: /joint_commands, grid: true, latency: 0.0005}\n"},
    {"two_clocks", false,
     "joints: {topic: /joint_states, clock: header.stamp}\ntick: /joint_states\ncommands: /joint_commands\n",
     -86'400'000'000'000, 1e-4},
};

class ManyLogsInEachForm : public RobotRunLog, public ::testing::WithParamInterface<std::tuple<Form, int>> {};

TEST_P(ManyLogsInEachForm, EqualTheRobotsCommands) {
  const auto& [form, seed] = GetParam();
  Robot robot = seed % 2 == 0 ? walker() : tank();
  if (form.by_timer) robot = robot.by_timer();
  LogFaults faults = real;
  if (seed % 4 >= 2) faults.drift = -faults.drift;
  const RobotRun run = robot.run(static_cast<std::uint64_t>(seed), faults, 1000);
  write(run, form.stamp_offset, form.stamp_drift);
  const auto report = replay(robot, form.lines);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->ticks_different, 0) << to_string(report->first.value_or(Divergence()));
  EXPECT_GT(report->ticks_compared, 850);
  EXPECT_GT(report->ticks_unknown(), 0);
  EXPECT_NEAR(static_cast<double>(report->ticks), 1000.0, 3.0);
  ASSERT_TRUE(report->tick);
  EXPECT_NEAR(report->tick->drift, faults.drift, 5e-5);
}

INSTANTIATE_TEST_SUITE_P(Forms, ManyLogsInEachForm,
                         ::testing::Combine(::testing::ValuesIn(forms), ::testing::Range(0, logs)),
                         [](const auto& parameter) {
                           return std::get<0>(parameter.param).name + std::string("_") +
                                  std::to_string(std::get<1>(parameter.param));
                         });

/// As if the robot had another controller from that command on.
void change_commands(RobotRun& run, std::size_t from) {
  for (std::size_t i = from; i < run.commands.size(); ++i)
    for (double& effort : run.commands[i].joints.effort) effort *= 1.01;
}

TEST_F(RobotRunLog, DiffersInEachKnownTickOfAnotherController) {
  RobotRun run = walker().run(7, real, 1000);
  change_commands(run, 0);
  write(run);
  const auto report = replay(walker(), by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_FALSE(report->within());
  EXPECT_GE(report->ticks_different, run.knowable(true));
  EXPECT_LT(report->ticks_in_doubt, 10);
  EXPECT_FALSE(report->timing);
}

TEST_F(RobotRunLog, DiffersInEveryTickIfNoneAgreesEvenIfAMessageIsMissingAtTheBeginning) {
  RobotRun run = walker().run(7, {}, 200);
  change_commands(run, 0);
  run.states[0].is_kept = run.states[1].is_kept = true;
  run.commands[0].is_kept = false;
  run.commands[2].logged = run.states[3].logged + 1;
  write(run);
  const auto report = replay(walker(), by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_FALSE(report->within());
  EXPECT_EQ(report->ticks_in_doubt, 0);
  EXPECT_GT(report->ticks_different, 190);
}

TEST_F(RobotRunLog, FindsTheTickFromWhichTheControllerIsAnother) {
  RobotRun run = walker().run(7, {0.1, 1e-4}, 1000);
  change_commands(run, 600);
  write(run);
  const auto report = replay(walker(), by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  ASSERT_TRUE(report->beyond);
  EXPECT_EQ(report->beyond->tick, 600);
  EXPECT_EQ(report->ticks_different, 400);
  EXPECT_EQ(report->ticks_unknown(), 0);
  EXPECT_FALSE(report->timing) << "it isn't the time";
}

TEST_F(RobotRunLog, FindsAnotherControllerInEachFormOfTicks) {
  for (const Form& form : forms) {
    RobotRun run = (form.by_timer ? walker().by_timer() : walker()).run(7, real, 1000);
    change_commands(run, 600);
    write(run, form.stamp_offset, form.stamp_drift);
    const auto report = replay(walker(), form.lines);
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    ASSERT_TRUE(report->beyond) << form.name;
    EXPECT_NEAR(static_cast<double>(report->beyond->tick), 600.0, 8.0) << form.name;
    EXPECT_GT(report->ticks_different, 340) << form.name;
  }
}

TEST_F(RobotRunLog, FindsThatTheCommandsComeTwoTicksLater) {
  RobotRun run = walker().run(7, {}, 300);
  for (RobotMessage& command : run.commands) command.logged += 2 * period;
  write(run);
  const std::string by_shift = "commands: {topic: /joint_commands, shift: ";
  for (const auto& [shift, expected] : {std::pair(0, 2), std::pair(-1, 3), std::pair(5, -3)}) {
    const auto report = replay(walker(), by_shift + std::to_string(shift) + "}\n");
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    EXPECT_FALSE(report->within());
    ASSERT_TRUE(report->timing) << shift;
    EXPECT_EQ(report->timing->shift, expected);
    EXPECT_EQ(report->timing->different, 0);
    EXPECT_GT(report->timing->ticks, 280);
  }
  const auto right = replay(walker(), by_shift + "2}\n");
  ASSERT_TRUE(right.ok()) << to_string(right.errors());
  EXPECT_TRUE(right->equal());
  EXPECT_FALSE(right->timing);
}

TEST_F(RobotRunLog, CountsALastingDifferenceAfterAMissingMessage) {
  RobotRun run = walker().run(7, {}, 400);
  run.states[200].is_kept = false;
  change_commands(run, 201);
  write(run);
  const auto report = replay(walker(), by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  ASSERT_TRUE(report->beyond);
  EXPECT_EQ(report->beyond->tick, 201);
  EXPECT_EQ(report->ticks_different, 199);
  EXPECT_THAT(to_string(report->remarks),
              HasSubstr("map.yaml:4:7: warning: the commands differ from tick 201 on, after a "
                        "message that is missing or late"));
}

// The reason for ticks at messages.
TEST_F(RobotRunLog, DiffersOnAGridWhereJitterAndDriftPutMessagesIntoOtherTicks) {
  const Robot parked("TankController", "tank.urdf", joints_of("tank.urdf"), false);
  write(parked.run(7, {0.1, 1e-4}, 1000));
  const auto on_grid = replay(parked, "commands: /joint_commands\n");
  ASSERT_TRUE(on_grid.ok()) << to_string(on_grid.errors());
  EXPECT_GT(on_grid->ticks_different, 100);
  EXPECT_FALSE(on_grid->tick);
  EXPECT_TRUE(on_grid->undecided());
  ASSERT_TRUE(on_grid->cause) << "tried, and it agrees";
  EXPECT_EQ(on_grid->cause->lines, std::vector<std::string>{"tick: /joint_states"});
  EXPECT_EQ(on_grid->cause->different, 0);
  const auto at_messages = replay(parked, by_message);
  ASSERT_TRUE(at_messages.ok()) << to_string(at_messages.errors());
  EXPECT_TRUE(at_messages->equal());
  EXPECT_EQ(at_messages->ticks_compared, 1000);
  EXPECT_EQ(at_messages->tick->topic, "/joint_states");
  EXPECT_EQ(at_messages->tick->missing, 0);
}

TEST_F(RobotRunLog, FindsThatTheControllerRunsAtAnotherRate) {
  write(walker().run(7, {0.1, 1e-4}, 500));
  std::ofstream(path("map.yaml"))
      << "rehearse_map: 1\ntime_step: 0.001\njoints: /joint_states\ncommands: /joint_commands\n";
  const auto report = replay_by(walker(), path("map.yaml"));
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_FALSE(report->within());
  EXPECT_TRUE(report->undecided());
  ASSERT_TRUE(report->cause);
  EXPECT_EQ(report->cause->lines, (std::vector<std::string>{"tick: /joint_states", "time_step: 0.002"}));
  EXPECT_EQ(report->cause->different, 0);
}

TEST_F(RobotRunLog, CallsTheControllerWithHeldInputsWhereAMessageIsMissing) {
  RobotRun run = walker().run(7, {}, 100);
  run.states[40].is_kept = run.states[41].is_kept = false;
  write(run);
  const auto report = replay(walker(), by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->ticks, 100) << "the time of the recording is the robot's";
  EXPECT_EQ(report->tick->missing, 2);
  EXPECT_EQ(report->ticks_without_message, 2);
  EXPECT_EQ(report->ticks_without_command, 0);
  EXPECT_EQ(report->ticks_in_doubt, 1) << "it differentiates across the hole";
  EXPECT_EQ(report->ticks_compared, 97);
  EXPECT_TRUE(report->equal());
}

TEST_F(RobotRunLog, TakesTheMessagesOfAnyTopicForTicks) {
  const RobotRun run = tank().run(3, {0.1, 1e-4}, 300);
  write(run);
  const auto report = replay(tank(), "tick: /joint_commands\ncommands: /joint_commands\n");
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_TRUE(report->equal()) << "each command has its inputs before it";
  EXPECT_EQ(report->ticks_compared, 300);
}

TEST_F(RobotRunLog, EqualsTheRobotsCommandsByTheStampsToo) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    write(walker().run(seed, real, 2000));
    const auto report = replay(walker(), std::string(by_message) + "clock: header.stamp\n");
    ASSERT_TRUE(report.ok()) << to_string(report.errors());
    EXPECT_TRUE(report->equal()) << to_string(report->first.value_or(Divergence()));
    EXPECT_GT(report->ticks_compared, 1700);
    EXPECT_GT(report->topics[0].backwards, 0) << "a message that was logged late";
  }
}

TEST_F(RobotRunLog, RefusesATimeStepThatIsNotThatOfTheTicks) {
  write(tank().run(3, real, 300));
  const auto report = replay(tank(), "tick: /joy\n");
  ASSERT_FALSE(report.ok());
  EXPECT_THAT(to_string(report.errors()), HasSubstr("map.yaml:5:7: error: the messages on '/joy' are 0.02"));
  EXPECT_THAT(to_string(report.errors()), HasSubstr(" s apart (median), and time_step is 0.002 s"));
}

}  // namespace
}  // namespace rehearse
