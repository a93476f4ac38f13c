// Logs of simulated robots, replayed into their controllers: the controllers repeat their commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/cdr.h>
#include <rehearse/gtest.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/replay.h>
#include <rehearse/trace.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "../../jpeg_file.h"
#include "logs/robot_log/log_replay.h"
#include "picture/picture.h"
#include "robot_log.h"
#include "support/environment_variable.h"
#include "support/files.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const fs::path models = fs::path(FIXTURES_DIR) / "models";
const fs::path goldens = fs::path(FIXTURES_DIR) / ".." / "golden";

class LogReplay : public ::testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_ / name; }

  /// Lines after the version.
  void map(const std::string& lines) const {
    std::ofstream(path("map.yaml"), std::ios::binary) << "rehearse_map: 1\n" << lines;
  }

  void log(const std::string& golden, const RobotLog& robot) const {
    write_log(goldens / golden, path("log.mcap"), robot);
  }

  Result<LogReplayReport> replay_it(const std::string& controller, const std::string& model) {
    options_.controller = controller;
    options_.model = models / model;
    options_.map = path("map.yaml");
    return replay_log(path("log.mcap"), path("run.mcap"), options_);
  }

  LogReplayReport replayed(const std::string& controller, const std::string& model) {
    auto report = replay_it(controller, model);
    EXPECT_TRUE(report.ok()) << (report ? "" : to_string(report.errors()));
    return report ? *std::move(report) : LogReplayReport{};
  }

  std::string refused(const std::string& controller, const std::string& model) {
    const auto report = replay_it(controller, model);
    EXPECT_FALSE(report.ok());
    EXPECT_FALSE(fs::exists(path("run.mcap"))) << "nothing is written";
    return report ? "" : to_string(report.errors());
  }

  Trace run() const {
    auto trace = Trace::load(path("run.mcap"));
    EXPECT_TRUE(trace.ok()) << (trace ? "" : to_string(trace.errors()));
    return *std::move(trace);
  }

  // The log of a tank that is driven by joystick: the simplest moving robot.
  RobotLog tank() const {
    RobotLog robot;
    robot.topics = {
        {"/Tank/joints", "/joint_states"}, {"/joy", "/joy"}, {"/Tank/Driver/output/joints", "/joint_commands"}};
    return robot;
  }
  static constexpr const char* tank_map =
      "time_step: 0.005\nbody: Tank\njoints: /joint_states\njoystick: /joy\ncommands: /joint_commands\n";

  LogReplayOptions options_;

 private:
  const test::TemporaryFolder folder_;
};

TEST_F(LogReplay, RepeatsTheCommandsOfATank) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  EXPECT_EQ(report.ticks, 1001);
  EXPECT_DOUBLE_EQ(report.duration, 5.005);
  EXPECT_EQ(report.start, tank().start);
  EXPECT_EQ(report.values, 4000) << "1000 ticks of 4 joints";
  EXPECT_TRUE(report.equal()) << to_string(report.first.value_or(Divergence()));
  EXPECT_TRUE(report.remarks.empty()) << to_string(report.remarks);
  ASSERT_EQ(report.topics.size(), 3u);
  EXPECT_EQ(report.topics[0].topic, "/joint_states");
  EXPECT_EQ(report.topics[0].type, "sensor_msgs/msg/JointState");
  EXPECT_EQ(report.topics[0].use, "joints");
  EXPECT_EQ(report.topics[0].used, 1001);
  EXPECT_NEAR(report.topics[0].rate, 200.0, 1e-6);
  EXPECT_GT(report.topics[0].out_of_order, 0) << "the log isn't sorted";
}

TEST_F(LogReplay, RepeatsTheCommandsOfARoverByItsScans) {
  RobotLog robot;
  robot.topics = {{"/Rover/joints", "/joint_states"},
                  {"/Rover/Scanner/scan", "/scan"},
                  {"/Rover/Rover/output/joints", "/joint_commands"}};
  log("Rover.StopsBeforeTheWall.mcap", robot);
  map("time_step: 0.005\nstart: first\njoints: /joint_states\nranges: {topic: /scan, device: Scanner}\n"
      "commands: /joint_commands\n");
  const LogReplayReport report = replayed("RoverController", "rover.urdf");
  EXPECT_EQ(report.values, 4000);
  EXPECT_TRUE(report.equal()) << to_string(report.first.value_or(Divergence()));
}

TEST_F(LogReplay, RepeatsTheCommandsOfAScoutByItsPictures) {
  RobotLog robot;
  robot.topics = {{"/Scout/joints", "/joint_states"},
                  {"/Scout/Laser/scan", "/scan"},
                  {"/Scout/Depth/image", "/camera/color/compressed"},
                  {"/Scout/Depth/depth", "/camera/depth"},
                  {"/Scout/Depth/camera_info", "/camera/camera_info"},
                  {"/Scout/Scout/output/joints", "/joint_commands"}};
  log("Scout.FindsItsWayThroughARoom.mcap", robot);
  map("time_step: 0.005\nstart: first\njoints: /joint_states\nranges: {topic: /scan, device: Laser}\n"
      "cameras: {topic: /camera/color/compressed, depth: /camera/depth, info: /camera/camera_info, device: Depth}\n"
      "commands: /joint_commands\n");
  const LogReplayReport report = replayed("ScoutController", "scout.urdf");
  EXPECT_EQ(report.values, 4800);
  EXPECT_TRUE(report.equal()) << to_string(report.first.value_or(Divergence()));
  EXPECT_EQ(report.pictures, 240);
  EXPECT_TRUE(report.remarks.empty()) << to_string(report.remarks);
  const auto again = replay(path("run.mcap"));
  ASSERT_TRUE(again.ok()) << to_string(again.errors());
  EXPECT_TRUE(again->equal());
}

/// A JPEG isn't encoded anew: the recording has its bytes, and a replay of the recording the pixels that were read.
TEST_F(LogReplay, KeepsJpegsAsTheyCame) {
  std::vector<std::vector<std::uint8_t>> logged, recorded;
  RobotLog robot;
  robot.topics = {
      {"/Scout/joints", "/joint_states"}, {"/Scout/Laser/scan", "/scan"}, {"/Scout/Depth/image", "/camera/color"}};
  robot.change = [&](const std::string& topic, std::vector<std::byte>& payload) {
    if (topic != "/camera/color") return;
    CdrReader reader(payload);
    msg::CompressedImage picture;
    ASSERT_TRUE(msg::decode(reader, picture));
    const auto image = decode_png(picture.data);
    ASSERT_TRUE(image.ok()) << to_string(image.errors());
    const auto width = static_cast<unsigned>(image->width), height = static_cast<unsigned>(image->height);
    picture.data = logged.emplace_back(test::jpeg_file(width, height, image->pixels, 85));
    picture.format = "jpeg";
    CdrWriter writer;
    msg::encode(picture, writer);
    payload.assign(writer.bytes().begin(), writer.bytes().end());
  };
  log("Scout.FindsItsWayThroughARoom.mcap", robot);
  map("time_step: 0.005\nstart: first\njoints: /joint_states\nranges: {topic: /scan, device: Laser}\n"
      "cameras: {topic: /camera/color, device: Depth}\n");
  EXPECT_EQ(replayed("ScoutController", "scout.urdf").pictures, 120);
  const auto recording = mcap::Reader::open(path("run.mcap"));
  ASSERT_TRUE(recording.ok()) << to_string(recording.errors());
  ASSERT_TRUE((*recording)->for_each_message([&](const mcap::Message& message) {
    CdrReader reader(message.data);
    msg::CompressedImage picture;
    if (message.channel->topic != "/Scout/Depth/image") return true;
    EXPECT_TRUE(msg::decode(reader, picture));
    EXPECT_THAT(picture.format, ::testing::StartsWith("rgb8; jpeg compressed bgr8; pixels "));
    recorded.push_back(picture.data);
    return true;
  }));
  EXPECT_EQ(recorded, logged);
  const auto again = replay(path("run.mcap"));
  ASSERT_TRUE(again.ok()) << to_string(again.errors());
  EXPECT_TRUE(again->equal());
}

TEST_F(LogReplay, RepeatsTheCommandsOfAHeadThatAsksForTheTimeOfItsPictures) {
  RobotLog robot;
  robot.topics = {{"/Head/joints", "/joint_states"},
                  {"/Head/Eye/image", "/eye"},
                  {"/Head/Follower/output/joints", "/joint_commands"}};
  log("CameraFollower.KeepsTheBallInTheMiddle.mcap", robot);
  map("time_step: 0.005\nstart: first\nbody: Head\njoints: /joint_states\ncameras: {topic: /eye, device: Eye}\n"
      "commands: /joint_commands\ntolerances: [{channel: \"*\", atol: 1.0e-10}]\n");
  const LogReplayReport report = replayed("CameraFollowerController", "pan_tilt_head.urdf");
  EXPECT_EQ(report.values, 1600);
  // the posture that the run began with was measured, by now, in the last bit
  EXPECT_TRUE(report.within()) << to_string(report.beyond.value_or(Divergence()));
}

TEST_F(LogReplay, IsAnOrdinaryRecording) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  const auto again = replay(path("run.mcap"));
  ASSERT_TRUE(again.ok()) << to_string(again.errors());
  EXPECT_TRUE(again->equal());
  EXPECT_EQ(again->ticks, 1001);
  EXPECT_TRUE(again->same_controllers);
  const Trace trace = run();
  EXPECT_EQ(trace.ticks(), 1001);
  const mcap::StringMap& facts = *trace.find_metadata("rehearse");
  EXPECT_EQ(facts.at("source"), "log");
  EXPECT_EQ(facts.at("log"), "log.mcap " + report.log_hash);
  EXPECT_THAT(facts.at("map"), HasSubstr("map.yaml "));
  EXPECT_EQ(facts.at("log.start"), "1763640000123456789");
  EXPECT_NE(trace.find_attachment("map.yaml"), nullptr);
  EXPECT_NE(trace.find_attachment("tank.urdf"), nullptr);
  EXPECT_EQ(trace.find_metadata("rehearse.log /joint_states")->at("used"), "1001");
}

TEST_F(LogReplay, GivesTheSameBytesEachTime) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  const auto bytes = [this] {
    replayed("TankController", "tank.urdf");
    return test::read_file(path("run.mcap"));
  };
  const std::string first = bytes();
  EXPECT_GT(first.size(), 10'000u);
  EXPECT_TRUE(first == bytes());
}

TEST_F(LogReplay, GoesByTheStampsIfTheMapSaysSo) {
  RobotLog robot = tank();
  robot.lateness = [](const std::string& topic, std::int64_t time) -> std::int64_t {
    if (topic == "/joint_commands") return 1'000'000;
    return topic == "/joy" ? 40'000'000 : 3'000'000 + time % 7 * 1'000'000;  // [ns]
  };
  log("Tank.IsDrivenByJoystick.mcap", robot);
  map(std::string(tank_map) + "clock: header.stamp\n");
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  EXPECT_EQ(report.values, 4000);
  EXPECT_TRUE(report.equal()) << to_string(report.first.value_or(Divergence()));
  map(tank_map);
  const LogReplayReport by_arrival = replayed("TankController", "tank.urdf");
  EXPECT_FALSE(by_arrival.within()) << "the joystick is eight ticks late";
}

TEST_F(LogReplay, ComparesWithCommandsOfLaterTicks) {
  RobotLog robot = tank();
  robot.lateness = [](const std::string& topic, std::int64_t) -> std::int64_t {
    return topic == "/joint_commands" ? 11'000'000 : 0;  // two ticks and a bit
  };
  log("Tank.IsDrivenByJoystick.mcap", robot);
  map(tank_map);
  EXPECT_FALSE(replayed("TankController", "tank.urdf").within());
  map("time_step: 0.005\nbody: Tank\njoints: /joint_states\njoystick: /joy\n"
      "commands: {topic: /joint_commands, shift: 2}\n");
  const LogReplayReport shifted = replayed("TankController", "tank.urdf");
  EXPECT_TRUE(shifted.equal()) << to_string(shifted.first.value_or(Divergence()));
  EXPECT_EQ(shifted.values, 4000);
}

TEST_F(LogReplay, TellsOfGaps) {
  RobotLog robot = tank();
  robot.keep = [](const std::string& topic, std::int64_t time) {
    return topic != "/joint_states" || time <= 1'000'000'000 || time >= 2'000'000'000;
  };
  log("Tank.IsDrivenByJoystick.mcap", robot);
  map(tank_map);
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  const LogTopicReport& joints = report.topics.at(0);
  EXPECT_EQ(joints.gaps, 1);
  EXPECT_EQ(joints.ticks_in_gaps, 179) << "200 ticks less the 20 of the first 0.1 s, and the one that ends it";
  EXPECT_NEAR(joints.longest_gap, 1.0, 1e-9);
  EXPECT_NEAR(joints.longest_gap_at, 1.0, 1e-9);
  EXPECT_NEAR(joints.worst_age, 0.995, 1e-9);
  const Trace trace = run();
  ASSERT_EQ(trace.events().size(), 1u);
  EXPECT_EQ(trace.events()[0].source, "log");
  EXPECT_EQ(trace.events()[0].severity, "warning");
  EXPECT_EQ(trace.events()[0].tick, 221);
  EXPECT_THAT(trace.events()[0].text, HasSubstr("nothing on /joint_states for more than 0.1 s"));
  EXPECT_EQ(trace.at("Tank/TURRET_Y/q", 1.9), trace.at("Tank/TURRET_Y/q", 1.0)) << "the last value is held";
}

TEST_F(LogReplay, StartsWhenAllIsThere) {
  RobotLog robot = tank();
  robot.keep = [](const std::string& topic, std::int64_t time) {
    return topic != "/joint_states" || time >= 500'000'000;
  };
  log("Tank.IsDrivenByJoystick.mcap", robot);
  map(tank_map);
  EXPECT_EQ(replayed("TankController", "tank.urdf").start, robot.start + 500'000'000);
  map(std::string(tank_map) + "start: first\n");
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  EXPECT_EQ(report.start, robot.start + 500'000'000) << "a joystick is nothing to wait for, nor to begin with";
}

TEST_F(LogReplay, EndsWhereItIsToldTo) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  options_.from = mcap::TimeBound{500'000'000};
  options_.until = mcap::TimeBound{1'000'000'000};
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  EXPECT_EQ(report.ticks, 200);
  EXPECT_EQ(report.ticks_compared, 100);
  EXPECT_EQ(run().ticks(), 200);
}

TEST_F(LogReplay, JudgesByTheMapsTolerances) {
  RobotLog robot;
  robot.topics = {{"/SR1/joints", "/joint_states"}, {"/SR1/SR1Minimum/output/joints", "/joint_commands"}};
  log("SR1.StandsUnderItsMinimumController.mcap", robot);
  map("time_step: 0.001\njoints: /joint_states\ncommands: /joint_commands\n");
  const LogReplayReport report = replayed("SR1MinimumController", "sr1.urdf");
  EXPECT_TRUE(report.within());
  ASSERT_TRUE(report.first) << "the posture that it holds was measured";
  EXPECT_EQ(report.first->unit, "N·m");
  map("time_step: 0.001\njoints: /joint_states\ncommands: /joint_commands\n"
      "tolerances: [{channel: \"SR1/*/u\", atol: 1.0e-15}]\n");
  const LogReplayReport strict = replayed("SR1MinimumController", "sr1.urdf");
  EXPECT_FALSE(strict.within());
  EXPECT_EQ(strict.beyond->tolerance, 1e-15);
}

TEST_F(LogReplay, ScalesRelativeTolerancesByTheLargestLoggedCommand) {
  RobotLog robot;
  robot.topics = {{"/SR1/joints", "/joint_states"}, {"/SR1/SR1Minimum/output/joints", "/joint_commands"}};
  const std::string golden = "SR1.StandsUnderItsMinimumController.mcap";
  log(golden, robot);
  map("time_step: 0.001\njoints: /joint_states\ncommands: /joint_commands\n"
      "tolerances: [{channel: \"SR1/*/u\", atol: 0, rtol: 1.0e-3}]\n");
  std::vector<Divergence> found;
  options_.on_difference = [&found](const Divergence& difference) { found.push_back(difference); };
  replayed("SR1MinimumController", "sr1.urdf");
  ASSERT_FALSE(found.empty());
  const auto recorded = Trace::load(goldens / golden);
  ASSERT_TRUE(recorded.ok());
  for (const Divergence& difference : found) {
    double largest = 0.0;
    for (const double effort : recorded->values("SR1/SR1Minimum/output/" + difference.element))
      largest = std::max(largest, std::abs(effort));
    ASSERT_EQ(difference.tolerance, 1e-3 * largest) << to_string(difference);
  }
}

TEST_F(LogReplay, RefusesAControllerThatReadsWhatNothingGives) {
  RobotLog robot;
  robot.topics = {{"/Quadruped/joints", "/joint_states"}};
  log("Trot.StandsUpAndWalksAhead.mcap", robot);
  map("time_step: 0.001\njoints: /joint_states\n");
  const std::string told = refused("TrotController", "quadruped.urdf");
  EXPECT_THAT(told, HasSubstr("reads the contact points of link 'FL_FOOT', which has no source in the map"));
  EXPECT_THAT(told, Not(HasSubstr("FL_KNEE"))) << "the joints are given";
}

TEST_F(LogReplay, RefusesATopicWithoutMessages) {
  RobotLog robot = tank();
  robot.keep = [](const std::string& topic, std::int64_t) { return topic != "/joint_states"; };
  log("Tank.IsDrivenByJoystick.mcap", robot);
  map(tank_map);
  EXPECT_THAT(refused("TankController", "tank.urdf"),
              HasSubstr("map.yaml:4:9: error: the log has no message on '/joint_states'"));
}

TEST_F(LogReplay, UsesWhatIsWholeOfADamagedLog) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  fs::resize_file(path("log.mcap"), fs::file_size(path("log.mcap")) / 2);
  map(tank_map);
  const LogReplayReport report = replayed("TankController", "tank.urdf");
  EXPECT_GT(report.ticks, 100);
  EXPECT_LT(report.ticks, 900);
  EXPECT_TRUE(report.equal());
  EXPECT_THAT(to_string(report.remarks), AllOf(HasSubstr("log.mcap: warning:"), HasSubstr("truncated")));
}

TEST_F(LogReplay, SaysThatALibraryIsNotThere) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  EXPECT_THAT(refused("NobodysController", "tank.urdf"),
              ::testing::StartsWith("error: controller library 'NobodysController' not found (looked for "));
}

TEST_F(LogReplay, BecomesAGoldenOfATest) {
  const test::EnvironmentVariable folder("REHEARSE_GOLDEN_DIR", path("golden").c_str()),
      pending("REHEARSE_PENDING", path("pending").c_str());
  const test::EnvironmentVariable no_ci("CI", nullptr);
  fs::create_directory(path("golden"));
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  options_.until = mcap::TimeBound{1'000'000'000};
  replayed("TankController", "tank.urdf");
  {
    const test::EnvironmentVariable mode("REHEARSE_GOLDEN", "new");
    const internal::TestVerdict written = internal::match_golden(run(), "Tank.AsInTheLog");
    EXPECT_TRUE(written.passed) << written.message;
  }
  const test::EnvironmentVariable mode("REHEARSE_GOLDEN", "check");
  const internal::TestVerdict repeated = internal::replay_golden("Tank.AsInTheLog", "Tank.Repeats");
  EXPECT_TRUE(repeated.passed) << repeated.message;
  replayed("TankController", "tank.urdf");
  const internal::TestVerdict again = internal::match_golden(run(), "Tank.AsInTheLog");
  EXPECT_TRUE(again.passed) << again.message;
  RobotLog robot = tank();
  robot.keep = [](const std::string& topic, std::int64_t time) { return topic != "/joy" || time >= 900'000'000; };
  log("Tank.IsDrivenByJoystick.mcap", robot);
  replayed("TankController", "tank.urdf");
  const internal::TestVerdict other = internal::match_golden(run(), "Tank.AsInTheLog");
  EXPECT_FALSE(other.passed) << "the joystick came later";
}

TEST_F(LogReplay, LeavesTheLogAlone) {
  log("Tank.IsDrivenByJoystick.mcap", tank());
  map(tank_map);
  options_.controller = "TankController";
  options_.model = models / "tank.urdf";
  options_.map = path("map.yaml");
  const auto report = replay_log(path("log.mcap"), path("log.mcap"), options_);
  ASSERT_FALSE(report.ok());
  EXPECT_THAT(to_string(report.errors()), HasSubstr("that is the log itself"));
}

}  // namespace
}  // namespace rehearse
