// A robot that calls one of our controllers at each message of its joints, and the log that it leaves: with jitter,
// drift, missing, late and unsorted messages.
#pragma once

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
#include <random>
#include <string>
#include <vector>

#include "logs/robot_log/log_replay.h"
#include "support/temporary_folder.h"

namespace rehearse {
namespace robot_run {

namespace fs = std::filesystem;

inline constexpr std::int64_t start = 1'763'640'000'123'456'789;  // [ns]
inline constexpr std::int64_t period = 2'000'000;                 // [ns]
inline constexpr std::int64_t latency = period / 4;               // of a command after its joint message [ns]

/// The clock and the losses of a log.
struct LogFaults {
  double jitter = 0.0;   // largest deviation from the regular time [periods]
  double drift = 0.0;    // relative error of the robot's clock
  double dropped = 0.0;  // share of messages that the log lacks
  double late = 0.0;     // share of messages that come, or are logged, up to one and a half periods late
};
inline constexpr LogFaults real{0.1, 1e-4, 0.01, 0.01};

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

/// std_msgs/msg/Float64MultiArray without its layout.
struct Efforts {
  static constexpr std::string_view type_name = "std_msgs/msg/Float64MultiArray";
  std::vector<double> data;
  REHEARSE_FIELDS(data)
};

struct RobotMessage {
  std::int64_t arrival = 0;  // at the controller, or from it [ns]
  std::int64_t logged = 0;   // [ns]
  bool is_kept = true;       // in the log
  msg::JointState joints;
  msg::Joy joy;
  Efforts efforts;  // of a command: those of `joints`
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

  /// A robot that calls its controller half a period after each regular time of its joint messages instead.
  Robot by_timer() const {
    Robot robot = *this;
    robot.by_timer_ = true;
    return robot;
  }

  RobotRun run(std::uint64_t seed, const LogFaults& faults, int ticks) const;
  const std::string& controller() const { return controller_; }
  const fs::path& model() const { return model_; }
  bool has_joystick() const { return has_joystick_; }

 private:
  void control(RobotRun& run, Chance& chance, const LogFaults& faults) const;

  std::string controller_;
  fs::path model_;
  std::vector<std::string> joints_;
  bool has_joystick_;
  bool by_timer_ = false;
};

inline std::vector<std::string> joints_of(const std::string& model) {
  UrdfOptions options;
  options.meshes = UrdfOptions::Meshes::skip;
  const auto loaded = load_urdf(fs::path(FIXTURES_DIR) / "models" / model, options);
  std::vector<std::string> names;
  for (const int link : loaded->joints) names.push_back(loaded->links[link].joint.name);
  return names;
}

/// Its commands depend on the message before, too: the controller differentiates.
inline Robot walker() { return {"SR1MinimumController", "sr1.urdf", joints_of("sr1.urdf"), false}; }
inline Robot tank() { return {"TankController", "tank.urdf", joints_of("tank.urdf"), true}; }

/// Messages of one topic, regular but for the faults. The first ones come in time and are in the log.
inline std::vector<RobotMessage> messages(std::int64_t first, std::int64_t step, int count, Chance& chance,
                                          const LogFaults& faults) {
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
  std::ranges::sort(made, [](const auto& a, const auto& b) { return a.arrival < b.arrival; });
  return made;
}

inline RobotRun Robot::run(std::uint64_t seed, const LogFaults& faults, int ticks) const {
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

/// Calls the controller at each message of the joints, or by the timer.
inline void Robot::control(RobotRun& run, Chance& chance, const LogFaults& faults) const {
  BenchOptions options;
  options.time_step = static_cast<double>(period) * 1e-9;
  for (std::size_t i = 0; i < joints_.size(); ++i) options.joints[joints_[i]] = run.states[0].joints.position[i];
  ControllerBench bench(controller_, model_.string(), options);
  const auto jitter = [&] { return chance.between(-faults.jitter, faults.jitter) * static_cast<double>(period); };
  std::size_t next_joy = 0, next_state = 0;
  for (std::size_t tick = 0; tick < run.states.size(); ++tick) {
    const double regular = static_cast<double>(period) * (static_cast<double>(tick) + 0.5) * (1.0 + faults.drift);
    const std::int64_t now = by_timer_ ? start + std::llround(regular + jitter() / 4) : run.states[tick].arrival;
    for (; next_joy < run.joy.size() && run.joy[next_joy].arrival <= now; ++next_joy) {
      bench.axis("L_STICK_H") = static_cast<double>(run.joy[next_joy].joy.axes[0]);
      bench.axis("L_STICK_V") = static_cast<double>(run.joy[next_joy].joy.axes[1]);
    }
    for (; next_state < run.states.size() && run.states[next_state].arrival <= now; ++next_state)
      for (std::size_t i = 0; i < joints_.size(); ++i) {
        bench.joint(joints_[i]).q = run.states[next_state].joints.position[i];
        bench.joint(joints_[i]).dq = run.states[next_state].joints.velocity[i];
      }
    ASSERT_TRUE(bench.tick());
    RobotMessage& command = run.commands.emplace_back();
    command.arrival = now + latency + std::llround(jitter());
    command.logged = command.arrival;
    if (chance.comes(faults.late))
      command.logged += std::llround(chance.between(0.6, 1.5) * static_cast<double>(period));
    command.is_kept = !chance.comes(faults.dropped);
    command.joints.name = joints_;
    for (const std::string& joint : joints_) {
      command.joints.velocity.push_back(bench.joint(joint).dq_target);
      command.joints.effort.push_back(bench.joint(joint).u);
    }
    command.efforts.data = command.joints.effort;
  }
}

inline std::int64_t RobotRun::knowable(bool has_state) const {
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
  /// Writes the messages of a run that the log has, unsorted in the file as recorders with several threads do.
  /// `stamp_drift` and `stamp_offset`: the clock of the joint messages' stamps against that of the log, [ns] at the
  /// start.
  void write(const RobotRun& run, std::int64_t stamp_offset = 0, double stamp_drift = 0.0) const {
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
        if constexpr (requires { payload.header; })
          payload.header.stamp = stamp_of(message.arrival, &messages == &run.states, stamp_offset, stamp_drift);
        CdrWriter cdr;
        msg::encode(payload, cdr);
        entries.push_back({channel, message.logged, {cdr.bytes().begin(), cdr.bytes().end()}});
      }
    };
    add("/joint_states", run.states, &RobotMessage::joints);
    if (!run.joy.empty()) add("/joy", run.joy, &RobotMessage::joy);
    add("/joint_commands", run.commands, &RobotMessage::joints);
    add("/other_joint_states", run.states, &RobotMessage::joints);
    add("/efforts", run.commands, &RobotMessage::efforts);
    std::ranges::stable_sort(
        entries, [](const Entry& a, const Entry& b) { return a.time / (5 * period) < b.time / (5 * period); });
    for (const Entry& entry : entries)
      ASSERT_TRUE((*writer)->write(entry.channel, static_cast<std::uint64_t>(entry.time),
                                   static_cast<std::uint64_t>(entry.time), entry.data));
    ASSERT_TRUE((*writer)->close());
  }

  static msg::Time stamp_of(std::int64_t time, bool has_other_clock, std::int64_t offset, double drift) {
    if (has_other_clock) time += offset + std::llround(static_cast<double>(time - start) * drift);
    return msg::Time::from_ns(static_cast<std::uint64_t>(time));
  }

  Result<LogReplayReport> replay(const Robot& robot, const std::string& lines, std::string controller = "") const {
    std::ofstream(path("map.yaml")) << "rehearse_map: 1\ntime_step: 0.002\n"
                                    << (lines.find("joints:") == std::string::npos ? "joints: /joint_states\n" : "")
                                    << (robot.has_joystick() ? "joystick: /joy\n" : "") << lines;
    return replay_by(robot, path("map.yaml"), std::move(controller));
  }

  Result<LogReplayReport> replay_by(const Robot& robot, const fs::path& map, std::string controller = "") const {
    LogReplayOptions options;
    options.controller = controller.empty() ? robot.controller() : std::move(controller);
    options.model = robot.model();
    options.map = map;
    return replay_log(path("log.mcap"), path("run.mcap"), options);
  }

  fs::path path(const char* file) const { return folder_ / file; }

  static constexpr const char* by_message = "tick: /joint_states\ncommands: /joint_commands\n";

 private:
  const test::TemporaryFolder folder_;
};

}  // namespace robot_run
}  // namespace rehearse
