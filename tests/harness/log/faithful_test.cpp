// Nothing of a log is repaired or left out without a word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/trace.h>

#include <limits>
#include <set>

#include "robot_run.h"
#include "support/printed_by_name.h"

namespace rehearse {
namespace {

using namespace robot_run;
using ::testing::AllOf;
using ::testing::HasSubstr;

class FaithfulLog : public RobotRunLog {
 protected:
  LogReplayReport replayed(const RobotRun& run, const std::string& lines = "") const {
    write(run);
    auto report = replay(tank(), lines);
    if (!report) throw std::runtime_error(to_string(report.errors()));
    return *std::move(report);
  }
};

void silence(RobotMessage& message, std::size_t joint) {
  const auto at = static_cast<std::ptrdiff_t>(joint);
  message.joints.name.erase(message.joints.name.begin() + at);
  message.joints.position.erase(message.joints.position.begin() + at);
  message.joints.velocity.erase(message.joints.velocity.begin() + at);
}

TEST_F(FaithfulLog, ReportsAJointThatFallsSilent) {
  RobotRun run = tank().run(1, {}, 600);
  const std::string joint = run.states[0].joints.name[2];
  for (int i = 200; i < 500; ++i) silence(run.states[i], 2);
  const LogReplayReport report = replayed(run);
  const LogTopicReport& joints = report.topics[0];
  ASSERT_EQ(joints.silent_joints.size(), 1u);
  EXPECT_EQ(joints.silent_joints[0].joint, joint);
  EXPECT_EQ(joints.silent_joints[0].gaps, 1);
  EXPECT_EQ(joints.silent_joints[0].ticks_in_gaps, 250) << "all but those of the first 0.1 s";
  EXPECT_EQ(joints.gaps, 0) << "the topic goes on";
  const auto trace = Trace::load(path("run.mcap"));
  ASSERT_TRUE(trace.ok());
  ASSERT_EQ(trace->events().size(), 1u);
  EXPECT_EQ(trace->events()[0].text,
            "nothing of joint " + joint + " on /joint_states for more than 0.1 s: its last value is held");
}

TEST_F(FaithfulLog, GivesNaNToTheControllerAndRecordsIt) {
  RobotRun run = tank().run(1, {}, 50);
  const std::string joint = run.states[0].joints.name[2];
  run.states[0].joints.position[2] = run.states[20].joints.position[2] = std::numeric_limits<double>::quiet_NaN();
  replayed(run);
  const auto trace = Trace::load(path("run.mcap"));
  ASSERT_TRUE(trace.ok());
  const std::vector<double> read = trace->values("Tank/TankController/input/" + joint + "/q");
  ASSERT_EQ(read.size(), 50u);
  EXPECT_TRUE(std::isnan(read[0])) << "no posture of ours takes its place";
  EXPECT_EQ(read[19], run.states[19].joints.position[2]);
  EXPECT_TRUE(std::isnan(read[20])) << "nor the value before";
  EXPECT_EQ(read[21], run.states[21].joints.position[2]);
}

TEST_F(FaithfulLog, NamesUnreadableMessagesWithTheReasonAndUsesNone) {
  RobotRun run = tank().run(1, {}, 100);
  for (const int i : {30, 31, 60}) run.states[i].joints.position.pop_back();
  run.states[70].joints.velocity.pop_back();
  const LogReplayReport report = replayed(run);
  const LogTopicReport& joints = report.topics[0];
  EXPECT_EQ(joints.unreadable, 4);
  EXPECT_EQ(joints.used, 96);
  EXPECT_EQ(joints.skipped, 0);
  EXPECT_DOUBLE_EQ(joints.worst_age, 0.004) << "since tick 29";
  ASSERT_EQ(joints.unreadable_for.size(), 2u);
  EXPECT_EQ(joints.unreadable_for[0].reason, "3 positions of 4 joints");
  EXPECT_EQ(joints.unreadable_for[0].messages, 3);
  EXPECT_DOUBLE_EQ(joints.unreadable_for[0].first_at, 0.06);
  EXPECT_EQ(joints.unreadable_for[1].reason, "3 velocities of 4 joints");
  EXPECT_THAT(to_string(report.remarks),
              HasSubstr("map.yaml:3:9: warning: 3 messages on '/joint_states' can't be read: 3 positions of 4 joints "
                        "(the first at 0.060 s)"));
}

TEST_F(FaithfulLog, RefusesASourceOfWhichNoMessageCanBeRead) {
  RobotRun run = tank().run(1, {}, 100);
  for (RobotMessage& message : run.states) message.joints.position.pop_back();
  write(run);
  const auto report = replay(tank(), "");
  ASSERT_FALSE(report.ok());
  EXPECT_THAT(to_string(report.errors()), HasSubstr("map.yaml:3:9: error: no message on '/joint_states' can be read: "
                                                    "the first has 3 positions of 4 joints"));
}

TEST_F(FaithfulLog, NamesTheCommandsThatTheLogLacks) {
  RobotRun run = tank().run(1, {}, 100);
  for (RobotMessage& command : run.commands) {
    command.joints.name.pop_back();
    command.joints.velocity.pop_back();
    command.joints.effort.pop_back();
  }
  const LogReplayReport report = replayed(run, "commands: /joint_commands\n");
  EXPECT_TRUE(report.equal());
  EXPECT_EQ(report.values, 300);
  EXPECT_THAT(to_string(report.remarks), HasSubstr("map.yaml:5:11: warning: 1 of 4 commanded numbers aren't compared: "
                                                   "'/joint_commands' has no TURRET_P/u"));
}

// The file is mapped: a read beyond its new end would raise SIGBUS.
TEST_F(FaithfulLog, EndsIfTheLogIsTruncatedWhileItIsRead) {
  write(tank().run(1, {}, 3000));
  std::ofstream(path("map.yaml")) << "rehearse_map: 1\ntime_step: 0.002\njoints: /joint_states\njoystick: /joy\n";
  LogReplayOptions options;
  options.controller = tank().controller();
  options.model = tank().model();
  options.map = path("map.yaml");
  options.progress = [&](std::int64_t, std::int64_t) { fs::resize_file(path("log.mcap"), 5000); };
  const auto report = replay_log(path("log.mcap"), path("run.mcap"), options);
  ASSERT_FALSE(report.ok());
  EXPECT_THAT(to_string(report.errors()), HasSubstr("log.mcap: error: it changed while it was read"));
  EXPECT_FALSE(fs::exists(path("run.mcap")));
}

TEST_F(FaithfulLog, TellsHowTheRunBegan) {
  RobotRun run = tank().run(1, {}, 100);
  const LogReplayReport report = replayed(run);
  const std::vector<double>& joints = run.states[0].joints.position;
  EXPECT_EQ(report.begin.joints, (std::vector{0.0, 0.0, joints[2], joints[3]})) << "tracks have no displacement";
  EXPECT_TRUE(report.begin.has_joystick);
  EXPECT_FALSE(report.begin.root);
  ASSERT_EQ(report.begin.joystick.size(), 10u) << "each message moves both axes";
  EXPECT_EQ(report.begin.joystick[0].at, 0.0);
  EXPECT_EQ(report.begin.joystick[1].at, 0.02);
  ASSERT_EQ(report.begin.joystick[1].axes.size(), 2u);
  EXPECT_EQ(report.begin.joystick[1].axes[0].first, "L_STICK_H");
  EXPECT_EQ(report.begin.joystick[1].axes[0].second, run.joy[1].joy.axes[0]);
}

struct BrokenForALog {
  const char* name;  // fixtures/broken/log_NAME.yaml
  int line, column;
  const char* message;
};

// clang-format off
const BrokenForALog all_broken_for_a_log[] = {
    {"name_that_never_occurs", 3, 40, "no message on '/joint_states' names 'turret_y'.*did you mean 'TURRET_Y'|known names in it"},
    {"two_names_of_a_joint", 3, 40, "'TURRET_P' and 'TURRET_Y' on '/joint_states' are the same joint, TURRET_Y.*one name"},
    {"two_topics_of_a_joint", 3, 25, "'/joint_states' and '/other_joint_states' both have TRACK_L, TRACK_R, TURRET_Y, TURRET_P .expected one source"},
    {"commands_name_that_never_occurs", 4, 44, "no message on '/joint_commands' names 'tower'"},
    {"commands_of_a_joint_too_few", 4, 19, "no message on '/efforts' can be read: the first has 4 numbers, where the map has 3 joints.*for each number"},
    {"commands_of_another_quantity", 4, 19, "nothing can be compared: the controller commands TRACK_L/dq, TRACK_R/dq, TURRET_Y/u, TURRET_P/u, and '/efforts' has TRACK_L/q, .*quantity"},
    {"commands_of_no_joint", 4, 19, "nothing can be compared: .*'/efforts' has no joint of the model"},
};
// clang-format on

class BrokenMapOfALog : public RobotRunLog, public ::testing::WithParamInterface<BrokenForALog> {};

TEST_P(BrokenMapOfALog, IsRefusedAtItsPlaceAndForNothingElse) {
  const BrokenForALog& broken = GetParam();
  write(tank().run(1, {}, 20));
  const fs::path map = fs::path(FIXTURES_DIR) / "broken" / ("log_" + std::string(broken.name) + ".yaml");
  const auto report = replay_by(tank(), map);
  ASSERT_FALSE(report.ok());
  ASSERT_EQ(report.errors().size(), 1u) << to_string(report.errors());
  const Diagnostic& first = report.errors()[0];
  EXPECT_EQ(first.file, map.string());
  EXPECT_EQ(first.line, broken.line) << to_string(first);
  EXPECT_EQ(first.column, broken.column) << to_string(first);
  EXPECT_THAT(to_string(first), ::testing::ContainsRegex(broken.message));
  EXPECT_FALSE(fs::exists(path("run.mcap")));
}

INSTANTIATE_TEST_SUITE_P(Files, BrokenMapOfALog, ::testing::ValuesIn(all_broken_for_a_log), test::by_name);

TEST(BrokenMapsOfLogs, AreAllInTheTable) {
  std::set<std::string> listed, present;
  for (const BrokenForALog& broken : all_broken_for_a_log) listed.insert("log_" + std::string(broken.name) + ".yaml");
  for (const auto& entry : fs::directory_iterator(fs::path(FIXTURES_DIR) / "broken"))
    if (const std::string name = entry.path().filename().string(); name.rfind("log_", 0) == 0) present.insert(name);
  EXPECT_EQ(present, listed);
}

}  // namespace
}  // namespace rehearse
