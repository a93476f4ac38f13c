// LogMap: which topic of a robot's log is which input of a controller, as a YAML file states it. fixtures/README.md
// describes the file's form.
//
// A map is read against the model and the log's topics, so every mistake (a joint, a device or a topic that isn't
// there, a type that doesn't fit) has its place in the file, and all of them are told in one go.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/scenario.h>

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "log_topics.h"

namespace rehearse {

/// Which time of a message counts.
enum class LogClock {
  log_time,      // when it was written into the log: what a controller on the robot knew by then
  header_stamp,  // when it was measured, by the clock of whoever sent it
};

/// What a value is at a tick.
enum class Sampling {
  hold,         // the latest message at or before it
  interpolate,  // between that and the next; angles of continuous joints the shorter way round, orientations by slerp
};

/// A topic, and how its messages become values at ticks.
struct LogSource {
  std::string topic;
  Sampling sampling = Sampling::hold;
  std::optional<double> max_age;  // a message older than this at a tick is a gap [s]; nullopt: none is
  Place place;                    // of the topic's name
};

/// How the log's name for a joint and its numbers become the model's: q = scale * position + offset,
/// dq = scale * velocity, u = effort / scale.
struct JointRename {
  int joint = 0;  // id in the model
  double scale = 1.0;
  double offset = 0.0;  // [rad] or [m]
};

/// JointState: joints that aren't renamed stand for those of the same name; names that the model doesn't have are
/// passed over.
struct JointSource : LogSource {
  std::map<std::string, JointRename> names;  // by the log's name
  bool differentiate = false;                // dq comes from the last two positions, not from the message
};

struct DeviceSource : LogSource {
  enum class Kind { imu, wrench, picture, depth, camera_info, ranges };
  Kind kind = Kind::imu;
  std::vector<int> devices;  // indices into the model's
};

/// An axis in a message; index -1: it rests.
struct JoyAxis {
  int index = -1;
  bool invert = false;
};

struct JoySource : LogSource {
  std::array<JoyAxis, joystick_axes.size()> axes;      // by joystick_axes
  std::array<int, joystick_buttons.size()> buttons{};  // by joystick_buttons; -1: never pressed
};

/// PoseStamped, or Odometry whose twist is in the root link's frame, as ROS has it.
struct RootSource : LogSource {
  bool has_covariance = false;  // as Odometry's pose has
  bool has_twist = false;
};

/// Commands that the robot's own controller gave. Those of tick k are what the log has from then on until the next
/// tick.
struct CommandSource : LogSource {
  enum class Quantity { position, velocity, effort };
  std::map<std::string, JointRename> names;  // JointState: by the log's name
  std::vector<std::optional<int>> joints;    // an array of numbers: joint id by element; nullopt: of none
  Quantity quantity = Quantity::effort;      // an array of numbers: what they are
  bool is_array = false;                     // the messages are arrays of numbers, not JointStates
  int shift = 0;                             // those of tick k are what the log has at tick k + shift
};

struct MappedController {
  std::string name;     // empty: the library's
  std::string options;  // its own option string
  bool delay = true;
};

struct LogMap {
  std::string file;          // as the user named it
  std::string text;          // the file's bytes
  std::string body;          // names the channels; the model's name if the map gives none
  double time_step = 0.001;  // of the controller [s]
  LogClock clock = LogClock::log_time;
  bool start_with_first = false;  // the first tick is at the first message; else when all that is mapped has arrived
  MappedController controller;
  std::vector<JointSource> joints;
  std::vector<DeviceSource> devices;
  std::optional<JoySource> joystick;
  std::optional<RootSource> root;
  std::optional<CommandSource> commands;
  std::vector<ToleranceRule> tolerances;  // of commands, by series name

  /// Reads and checks a map against the model and the log's topics.
  static Result<LogMap> load(const std::filesystem::path& file, const Model& model,
                             const std::vector<LogTopic>& topics);
  /// The same from text in memory; `file` stands in messages.
  static Result<LogMap> parse(std::string text, const std::string& file, const Model& model,
                              const std::vector<LogTopic>& topics);
};

}  // namespace rehearse
