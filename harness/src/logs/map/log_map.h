// LogMap: assigns topics of a robot's log to inputs of a controller, from a YAML file. The page reference/map.md
// describes the file format.
//
// A map is checked against the model and the log's topics. So every mistake (a missing joint, device or topic, a type
// that doesn't fit) has its place in the file, and all mistakes are reported together.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/scenario.h>

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/kinds/kind.h"
#include "log_topics.h"

namespace rehearse {

/// The time of a message that is used.
enum class LogClock {
  log_time,      // when it was written into the log: a controller on the robot could have it at this time
  header_stamp,  // when it was measured, by the sender's clock
};

/// The angles in messages of joints.
enum class LogAngles {
  radians,
  degrees,  // and velocities in degrees per second
  wrapped,  // in radians, within half a turn of 0: they jump by a turn, which is taken out
};

/// Of several commands of a tick, the one that is compared. On a grid it is always the last.
enum class TakenCommand { first, last };

/// The value of a source at a tick.
enum class Sampling {
  hold,         // the latest message up to the tick
  interpolate,  // between that and the next; angles of continuous joints the shorter way round, orientations by slerp
};

/// A topic, and the rule that converts its messages to values at ticks.
struct LogSource {
  std::string topic;
  std::string later_topic;  // its name from some time of the log on; empty: it isn't renamed
  Sampling sampling = Sampling::hold;
  std::optional<double> max_age;  // an older message at a tick is a gap [s]; nullopt: there are no gaps
  LogClock clock = LogClock::log_time;
  std::optional<double> clock_offset;  // of the log's clock from the stamps' [s]; nullopt: estimated if it is needed
  Place place;                         // of the topic's name

  /// True if the messages of that topic of the log are the source's.
  bool is_on(std::string_view name) const { return name == topic || (!later_topic.empty() && name == later_topic); }
};

/// The ticks of the controller, by the messages of a topic.
struct TickSource : LogSource {
  bool grid = false;              // evenly spaced, with the rate and the phase of the messages; false: at the messages
  std::optional<double> latency;  // of commands: from the tick to the message [s]; nullopt: measured
  bool before_commands = false;   // the topic contains the commands, and ticks are earlier by the latency
};

/// Converts the log's name and numbers of a joint to the model's: q = scale * position + offset, dq = scale * velocity,
/// u = effort / scale.
struct JointRename {
  int joint = 0;  // id in the model
  double scale = 1.0;
  double offset = 0.0;    // [rad] or [m]
  Place place;            // of the log's name; not set for a joint that isn't renamed
  bool is_later = false;  // the joint has this name from some time of the log on
};

/// JointState: joints that aren't renamed are those of the same name; names that the model doesn't have are ignored.
struct JointSource : LogSource {
  std::map<std::string, JointRename> names;  // by the log's name
  bool differentiate = false;                // dq is computed from the last two positions, not read from the message
};

struct DeviceSource : LogSource {
  const LogInput* input = nullptr;  // never null in a map
  std::vector<int> devices;         // indices into the model's
};

/// An axis in a message; index -1: it stays at rest.
struct JoyAxis {
  int index = -1;
  bool invert = false;
  double scale = 1.0;
};

/// Joy, or Twist: its linear and angular x, y, z are the axes 0 to 5.
struct JoySource : LogSource {
  bool is_twist = false;
  std::array<JoyAxis, joystick_axes.size()> axes;      // by joystick_axes
  std::array<int, joystick_buttons.size()> buttons{};  // by joystick_buttons; -1: never pressed
};

/// PoseStamped, or Odometry whose twist is in the root link's frame, as in ROS; or the transform of a frame in a
/// TFMessage.
struct RootSource : LogSource {
  std::string frame;            // of a TFMessage: the child frame; empty for the other types
  bool has_covariance = false;  // as Odometry's pose has
  bool has_twist = false;
};

/// Commands of the robot's own controller. The command of tick k is in the log from the time of the tick until the next
/// tick: the last message on a grid, the first if ticks are messages.
struct CommandSource : LogSource {
  enum class Quantity { position, velocity, effort };
  std::map<std::string, JointRename> names;  // JointState: by the log's name
  std::vector<std::optional<int>> joints;    // for an array of numbers: joint id by element; nullopt: no joint
  Quantity quantity = Quantity::effort;      // for an array of numbers: their quantity
  bool is_array = false;                     // the messages are arrays of numbers, not JointStates
  int shift = 0;                             // the commands of tick k are those in the log at tick k + shift
};

/// Arrays of the numbers that the robot's controller needed to continue, each published after a call of control().
struct StateSource : LogSource {
  std::vector<std::optional<std::string>> names;  // for which rehearse_state() takes each number; nullopt: none
};

struct MappedController {
  std::string name;     // empty: the library's
  std::string options;  // its option string
  bool delay = true;
};

/// The time of the first tick.
struct StartRule {
  enum class When {
    all,    // each input has had a message
    first,  // the first message of an input
    topic,  // the first message of a topic of the map
    time,   // some time after all
  };
  When when = When::all;
  std::string topic;
  double seconds = 0.0;
};

struct LogMap {
  std::string file;                // as the user named it
  std::string text;                // the file's bytes
  std::string body;                // the body in channel names; the model's name if the map states none
  double time_step = 0.001;        // of the controller [s]
  std::optional<TickSource> tick;  // nullopt: ticks are a grid of time_step from the first message on
  StartRule start;
  std::vector<double>
      restarts;  // a fresh controller starts at each of these times; rising [s] from the log's beginning
  /// True: the controller starts at the first tick. False: the log may begin in the middle of a run.
  bool begins_with_controller = false;
  /// True: the controller isn't called where messages of the tick's topic are missing. False: it is, on old inputs.
  bool skips_missing = false;
  LogAngles angles = LogAngles::radians;
  TakenCommand take = TakenCommand::first;
  /// True: a message whose commands are all 0 isn't the controller's, but an emergency stop's.
  bool zeros_are_foreign = false;
  /// The magnitudes at which a driver clipped the commands, by joint id [unit of the command].
  std::map<int, double> limits;
  MappedController controller;
  std::vector<JointSource> joints;
  std::vector<DeviceSource> devices;
  std::optional<JoySource> joystick;
  std::optional<RootSource> root;
  std::optional<CommandSource> commands;
  std::optional<StateSource> state;
  std::vector<ToleranceRule> tolerances;  // of commands, by series name

  /// Reads and checks a map against the model and the log's topics.
  static Result<LogMap> load(const std::filesystem::path& file, const Model& model,
                             const std::vector<LogTopic>& topics);
  /// Reads a map from text in memory; `file` is used in messages.
  static Result<LogMap> parse(std::string text, const std::string& file, const Model& model,
                              const std::vector<LogTopic>& topics);

  /// Calls `use` with each source, and the tick.
  template <class Use>
  void each_source(Use&& use) {
    for (JointSource& source : joints) use(source);
    for (DeviceSource& source : devices) use(source);
    if (joystick) use(*joystick);
    if (root) use(*root);
    if (commands) use(*commands);
    if (state) use(*state);
    if (tick) use(*tick);
  }
};

}  // namespace rehearse
