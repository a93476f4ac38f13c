// Logs as robots make them: jitter, drift, missing, late and unsorted messages. A robot of this file calls one of our
// controllers at each message of its joints. The replay of its log equals its commands wherever the log has the inputs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/cdr.h>
#include <rehearse/controller_bench.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/urdf.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>

#include "log/log_replay.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr std::int64_t start = 1'763'640'000'123'456'789;  // [ns]
constexpr std::int64_t period = 2'000'000;                 // [ns]
constexpr std::int64_t latency = period / 4;               // of a command after its joint message [ns]

/// The clock and the losses of a log.
struct Faults {
  double jitter = 0.0;   // largest deviation from the regular time [periods]
  double drift = 0.0;    // relative error of the robot's clock
  double dropped = 0.0;  // share of messages that the log lacks
  double late = 0.0;     // share of messages that come, or are logged, up to one and a half periods late
};
constexpr Faults real{0.1, 1e-4, 0.01, 0.01};

/// Numbers that are the same on every machine.
class Chance {
 public:
  explicit Chance(std::uint64_t seed) : numbers_(seed) {}
  double between(double lower, double upper) {
    return lower + (upper - lower) * static_cast<double>(numbers_() >> 11) * 0x1p-53;
  }
  bool comes(double share) { return between(0.0, 1.0) < share; }

 private:
  std::mt19937_64 numbers_;
};

struct RobotMessage {
  std::int64_t arrival = 0;  // at the controller, or from it [ns]
  std::int64_t logged = 0;   // [ns]
  bool is_kept = true;       // in the log
  msg::JointState joints;
  msg::Joy joy;
};

/// A run of a robot with its messages in the order of their arrival.
struct RobotRun {
  std::vector<RobotMessage> states;
  std::vector<RobotMessage> joy;
  std::vector<RobotMessage> commands;  // parallel to states

  /// Number of ticks whose inputs, and whose command, are in the log as the robot had them. `has_state`: the controller
  /// needs the inputs of the tick before, too.
  std::int64_t knowable(bool has_state) const;
};

class Robot {
 public:
  Robot(std::string controller, const std::string& model, std::vector<std::string> joints, bool has_joystick)
      : controller_(std::move(controller)),
        model_(fs::path(FIXTURES_DIR) / "models" / model),
        joints_(std::move(joints)),
        has_joystick_(has_joystick) {}

  RobotRun run(std::uint64_t seed, const Faults& faults, int ticks) const;
  const std::string& controller() const { return controller_; }
  const fs::path& model() const { return model_; }
  bool has_joystick() const { return has_joystick_; }

 private:
  void control(RobotRun& run, Chance& chance, const Faults& faults) const;

  std::string controller_;
  fs::path model_;
  std::vector<std::string> joints_;
  bool has_joystick_;
};

std::vector<std::string> joints_of(const std::string& model) {
  UrdfOptions options;
  options.meshes = UrdfOptions::Meshes::skip;
  const auto loaded = load_urdf(fs::path(FIXTURES_DIR) / "models" / model, options);
  std::vector<std::string> names;
  for (const int link : loaded->joints) names.push_back(loaded->links[link].joint.name);
  return names;
}

/// Its commands depend on the message before, too: the controller differentiates.
Robot walker() { return {"SR1MinimumController", "sr1.urdf", joints_of("sr1.urdf"), false}; }
Robot tank() { return {"TankController", "tank.urdf", joints_of("tank.urdf"), true}; }

/// Messages of one topic, regular but for the faults. The first ones come in time and are in the log.
std::vector<RobotMessage> messages(std::int64_t first, std::int64_t step, int count, Chance& chance,
                                   const Faults& faults) {
  std::vector<RobotMessage> made;
  for (int i = 0; i < count; ++i) {
    RobotMessage& message = made.emplace_back();
    const double ideal = static_cast<double>(step) * i * (1.0 + faults.drift);
    const double off = chance.between(-faults.jitter, faults.jitter) * static_cast<double>(period);
    message.arrival = first + std::llround(ideal + off);
    const bool is_late = chance.comes(faults.late) && i > 3;
    if (is_late) message.arrival += std::llround(chance.between(0.0, 1.5) * static_cast<double>(period));
    message.logged = message.arrival;
    message.is_kept = !chance.comes(faults.dropped) || i <= 3;
  }
  std::sort(made.begin(), made.end(), [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
  return made;
}

RobotRun Robot::run(std::uint64_t seed, const Faults& faults, int ticks) const {
  Chance chance(seed);
  RobotRun run;
  run.states = messages(start, period, ticks, chance, faults);
  for (RobotMessage& message : run.states) {
    message.joints.name = joints_;
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      message.joints.position.push_back(chance.between(-0.01, 0.01));
      message.joints.velocity.push_back(chance.between(-1.0, 1.0));
    }
    // logged late, but the controller had it in time
    if (chance.comes(faults.late / 2) && &message - run.states.data() > 3)
      message.logged += std::llround(chance.between(0.6, 1.5) * static_cast<double>(period));
  }
  if (has_joystick_) run.joy = messages(start - period / 3, 10 * period, ticks / 10, chance, faults);
  for (RobotMessage& message : run.joy) {
    message.joy.axes = {static_cast<float>(chance.between(-1.0, 1.0)), static_cast<float>(chance.between(-1.0, 1.0))};
    message.joy.axes.resize(8);
    message.joy.buttons.resize(11);
  }
  control(run, chance, faults);
  return run;
}

/// Calls the controller at each message of the joints.
void Robot::control(RobotRun& run, Chance& chance, const Faults& faults) const {
  BenchOptions options;
  options.time_step = static_cast<double>(period) * 1e-9;
  for (std::size_t i = 0; i < joints_.size(); ++i) options.joints[joints_[i]] = run.states[0].joints.position[i];
  ControllerBench bench(controller_, model_.string(), options);
  std::size_t next_joy = 0;
  for (const RobotMessage& message : run.states) {
    for (; next_joy < run.joy.size() && run.joy[next_joy].arrival <= message.arrival; ++next_joy) {
      bench.axis("L_STICK_H") = static_cast<double>(run.joy[next_joy].joy.axes[0]);
      bench.axis("L_STICK_V") = static_cast<double>(run.joy[next_joy].joy.axes[1]);
    }
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      bench.joint(joints_[i]).q = message.joints.position[i];
      bench.joint(joints_[i]).dq = message.joints.velocity[i];
    }
    ASSERT_TRUE(bench.tick());
    RobotMessage& command = run.commands.emplace_back();
    const double off = chance.between(-faults.jitter, faults.jitter) * static_cast<double>(period);
    command.arrival = message.arrival + latency + std::llround(off);
    command.logged = command.arrival;
    if (chance.comes(faults.late))
      command.logged += std::llround(chance.between(0.6, 1.5) * static_cast<double>(period));
    command.is_kept = !chance.comes(faults.dropped);
    command.joints.name = joints_;
    for (const std::string& joint : joints_) {
      command.joints.velocity.push_back(bench.joint(joint).dq_target);
      command.joints.effort.push_back(bench.joint(joint).u);
    }
  }
}

std::int64_t RobotRun::knowable(bool has_state) const {
  const auto is_in_log_as_it_was = [](const RobotMessage& message) {
    return message.is_kept && message.logged == message.arrival;
  };
  std::int64_t count = 0;
  std::size_t next_joy = 0;
  for (std::size_t i = 1; i + 1 < states.size(); ++i) {
    while (next_joy < joy.size() && joy[next_joy].arrival <= states[i].arrival) ++next_joy;
    const RobotMessage &before = states[i - 1], &state = states[i], &command = commands[i];
    const bool has_inputs = is_in_log_as_it_was(state) && (!has_state || is_in_log_as_it_was(before)) &&
                            (next_joy == 0 || joy[next_joy - 1].is_kept);
    // no other message comes between, so that the command can't be another tick's
    const bool is_alone = before.arrival + latency + period / 10 < state.arrival &&
                          commands[i - 1].logged < state.arrival && commands[i].logged < states[i + 1].arrival &&
                          states[i - 1].logged < state.arrival;
    if (has_inputs && is_alone && is_in_log_as_it_was(command)) ++count;
  }
  return count;
}

class RobotRunLog : public ::testing::Test {
 protected:
  RobotRunLog()
      : folder_(fs::path(::testing::TempDir()) / ("rehearse_robot_" + std::to_string(getpid()) +
                                                  ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
  }
  ~RobotRunLog() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  /// Writes the messages of a run that the log has, unsorted in the file as recorders with several threads do.
  void write(const RobotRun& run) const {
    mcap::WriterOptions options;
    options.chunk_size = 64 * 1024;
    const auto writer = mcap::Writer::create(folder_ / "log.mcap", options);
    ASSERT_TRUE(writer.ok());
    struct Entry {
      std::uint16_t channel;
      std::int64_t time;
      std::vector<std::byte> data;
    };
    std::vector<Entry> entries;
    const auto add = [&](const char* topic, const std::vector<RobotMessage>& messages, auto member) {
      using Payload = std::remove_cvref_t<decltype(messages[0].*member)>;
      const auto schema =
          (*writer)->add_schema(std::string(Payload::type_name), "ros2msg", msg::schema_text<Payload>());
      const auto channel = (*writer)->add_channel(schema, topic, "cdr");
      for (const RobotMessage& message : messages) {
        if (!message.is_kept) continue;
        Payload payload = message.*member;
        payload.header.stamp = msg::Time::from_ns(static_cast<std::uint64_t>(message.arrival));
        CdrWriter cdr;
        msg::encode(payload, cdr);
        entries.push_back({channel, message.logged, {cdr.bytes().begin(), cdr.bytes().end()}});
      }
    };
    add("/joint_states", run.states, &RobotMessage::joints);
    if (!run.joy.empty()) add("/joy", run.joy, &RobotMessage::joy);
    add("/joint_commands", run.commands, &RobotMessage::joints);
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return a.time / (5 * period) < b.time / (5 * period); });
    for (const Entry& entry : entries)
      ASSERT_TRUE((*writer)->write(entry.channel, static_cast<std::uint64_t>(entry.time),
                                   static_cast<std::uint64_t>(entry.time), entry.data));
    ASSERT_TRUE((*writer)->close());
  }

  Result<LogReplayReport> replay(const Robot& robot, const std::string& lines, std::string controller = "") const {
    std::ofstream(folder_ / "map.yaml") << "rehearse_map: 1\ntime_step: 0.002\njoints: /joint_states\n"
                                        << (robot.has_joystick() ? "joystick: /joy\n" : "") << lines;
    LogReplayOptions options;
    options.controller = controller.empty() ? robot.controller() : std::move(controller);
    options.model = robot.model();
    options.map = folder_ / "map.yaml";
    return replay_log(folder_ / "log.mcap", folder_ / "run.mcap", options);
  }

  static constexpr const char* by_message = "tick: /joint_states\ncommands: /joint_commands\n";

 private:
  fs::path folder_;
};

class FiftyLogs : public RobotRunLog, public ::testing::WithParamInterface<int> {};

TEST_P(FiftyLogs, EqualTheRobotsCommandsWhereTheLogHasTheirInputs) {
  const int seed = GetParam();
  const Robot robot = seed % 2 == 0 ? walker() : tank();
  Faults faults = real;
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

INSTANTIATE_TEST_SUITE_P(Seeds, FiftyLogs, ::testing::Range(0, 50));

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
  ASSERT_TRUE(on_grid->timing);
  EXPECT_EQ(on_grid->timing->shift, std::nullopt) << "it is the neighbouring tick, before or after";
  const auto at_messages = replay(parked, by_message);
  ASSERT_TRUE(at_messages.ok()) << to_string(at_messages.errors());
  EXPECT_TRUE(at_messages->equal());
  EXPECT_EQ(at_messages->ticks_compared, 1000);
  EXPECT_EQ(at_messages->tick->topic, "/joint_states");
  EXPECT_EQ(at_messages->tick->missing, 0);
}

TEST_F(RobotRunLog, CallsTheControllerWithHeldInputsWhereAMessageIsMissing) {
  RobotRun run = walker().run(7, {}, 100);
  run.states[40].is_kept = run.states[41].is_kept = false;
  write(run);
  const auto report = replay(walker(), by_message);
  ASSERT_TRUE(report.ok()) << to_string(report.errors());
  EXPECT_EQ(report->ticks, 100) << "the time of the recording is the robot's";
  EXPECT_EQ(report->tick->missing, 2);
  EXPECT_EQ(report->ticks_without_command, 2);
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
