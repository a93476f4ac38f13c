// Log replay: feeds the log of a real robot to a controller, without physics. A log is a ROS 2 bag (MCAP, cdr). A map,
// a YAML file described in the page reference/map.md, assigns topics to inputs.
//
// The result is an ordinary recording: the inputs of the controller at its ticks, and its commands. It can be replayed
// (replay.h), compared and accepted as a golden; it has no physics to repeat. Links neither ODE nor OSMesa.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/run_options.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/trace/select.h"
#include "logs/map/log_map.h"

namespace rehearse {

class CommandRecord;

/// Times of a log [ns].
struct LogSpan {
  std::int64_t beginning = 0;         // of the log: its first message
  std::int64_t ending = 0;            // its last message
  std::optional<std::int64_t> begin;  // no tick is earlier
  std::optional<std::int64_t> end;    // nor at or after this time
  std::int64_t compared_from = 0;     // commands before this time are not compared
  std::optional<std::int64_t> most_ticks;
};

struct LogReplayOptions : HostOptions {
  std::string controller;                // the library, a name or a path
  std::filesystem::path model;           // the robot, a URDF or .body file
  std::filesystem::path map;             // assigns topics to inputs
  std::optional<mcap::TimeBound> from;   // commands before this time are not compared
  std::optional<mcap::TimeBound> until;  // end of the replay, not included
  /// Called with each difference from the log's commands, in the order of ticks and in the controllers' process; null:
  /// not.
  std::function<void(const Divergence&)> on_difference;
  // Set by replay_log(), also to find out which ticks are certain (log_memory.h):
  LogSpan span;
  std::int64_t skip = 0;              // ticks by which the replay begins later
  CommandRecord* commands = nullptr;  // takes the commands that are compared; null: not recorded
  /// The controller's memory. With it certain ticks are counted; a controller without a limit of memory has none in it.
  std::optional<std::optional<std::int64_t>> memory;
  std::optional<std::int64_t> restart_at;   // in that tick another controller continues with the state of the first one
  bool tolerates_steps = false;             // half a step of rounded commands is a part of their tolerance
  std::map<int, double> half_steps;         // the positions of these joints are moved by so much up or down, by id
  std::optional<std::int64_t> most_beyond;  // the replay ends after more ticks beyond a tolerance
  /// Called about every hundredth of the log with the number of ticks done and of all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// Spans in which values at ticks were older than the map allows; the ticks used the last value. Times are seconds from
/// the first tick on.
struct LogGaps {
  double worst_age = 0.0;          // largest age of a value at a tick [s]
  double worst_age_at = 0.0;       // time of that tick [s]
  std::int64_t gaps = 0;           // number of such spans
  std::int64_t ticks_in_gaps = 0;  // ticks in them
};

/// A joint with gaps while its topic had messages of other joints.
struct SilentJoint : LogGaps {
  std::string joint;
};

/// A name of a joint that the model doesn't have.
struct LogStranger {
  std::string name;
  double first_at = 0.0;  // [s] from the first tick on
};

/// Messages that can't be read, for one reason.
struct LogUnreadable {
  std::string reason;
  std::int64_t messages = 0;
  double first_at = 0.0;  // [s] from the first tick on
};

/// The offset of a topic's stamps from the log's clock.
struct LogClockReport {
  std::int64_t offset = 0;     // at `reference` [ns]: log's clock minus stamp; 0: the clocks agree
  double drift = 0.0;          // growth of the offset per time
  std::int64_t reference = 0;  // a stamp [ns]
  double least_delay = 0.0;    // smallest log time minus stamp [s]
  bool is_stated = false;      // by the map, not estimated
  std::int64_t steps = 0;      // of a clock; offset and drift are those before the first
};

/// The use of a topic of the log in the replay. Times are seconds from the first tick on; earlier ones are negative.
struct LogTopicReport : LogGaps {
  std::string topic;
  std::string type;           // sensor_msgs/msg/Imu
  std::string use;            // "joints", "WaistIMU", "commands"
  std::int64_t messages = 0;  // in the log
  std::int64_t used = 0;      // used in at least one tick
  /// Messages that were replaced between two ticks, or came before the first or after the last.
  std::int64_t skipped = 0;
  std::int64_t out_of_order = 0;  // messages after one of a later log time in the file
  std::int64_t same_stamp = 0;    // messages with the time of the previous message
  std::int64_t backwards = 0;     // messages with an earlier time than the previous message; they are not used
  std::int64_t unreadable = 0;    // messages that can't be read; they are not used
  std::vector<LogUnreadable> unreadable_for;  // the first reasons, in the order of their first messages
  std::vector<SilentJoint> silent_joints;
  std::vector<LogStranger> strangers;   // of joints
  std::int64_t twins = 0;               // messages that were recorded before; they are not used
  std::optional<LogClockReport> clock;  // of stamps that were converted to the log's clock
  double rate = 0.0;                    // messages per second, over all of them; 0 for fewer than two
  double longest_gap = 0.0;             // between two messages [s]
  double longest_gap_at = 0.0;          // where it begins [s]
  std::int64_t ticks_without = 0;       // ticks before its first message
};

/// Ticks by the messages of a topic.
struct LogTickReport {
  std::string topic;
  bool is_grid = false;           // evenly spaced, not at the messages
  double interval = 0.0;          // between two messages, median [s]
  double rate = 0.0;              // of the messages [Hz], estimated from all of them
  double drift = 0.0;             // of their interval from time_step, relative
  double jitter = 0.0;            // nine of ten messages are within this time of their regular times [s]
  double phase = 0.0;             // of the ticks after the messages [s]; negative: before
  std::int64_t missing = 0;       // ticks whose message is missing
  std::optional<double> latency;  // from a tick to its command, median [s]
  std::string measured_by;        // the input of which the latency is half the time to the command; else empty
};

/// A timing of the commands at which nine of ten ticks that differ agree.
struct LogTiming {
  /// The log has the commands this number of ticks later; none: at the tick before or after.
  std::optional<int> shift;
  std::int64_t ticks = 0;  // ticks compared with this timing; without shift, the ticks that differ
  std::int64_t different = 0;
};

/// Another reading of the log, with which nine of ten ticks that differ agree.
struct LogCause {
  std::vector<std::string> lines;  // of the map, as `start: first`
  std::string meaning;             // in words, as "the controller starts with the first message"
  std::int64_t ticks = 0;          // ticks compared with it
  std::int64_t different = 0;      // of them, beyond their tolerance
};

/// The differences of a number in the ticks that aren't certain, from the first one beyond its tolerance on.
struct LogRest {
  std::string series;  // joint and quantity, as PAN/u; that with the largest share of its range
  std::string unit;
  double from = 0.0;             // [s]
  std::int64_t ticks = 0;        // compared
  double low = 0.0, high = 0.0;  // replayed minus logged, in the unit of the series
  double range = 0.0;            // of the log's commands

  double largest() const { return std::max(std::abs(low), std::abs(high)); }
  /// In share of the range.
  double share() const { return range > 0.0 ? largest() / range : 0.0; }
  /// The difference stays within a fifth of the largest one.
  bool is_constant() const { return ticks > 20 && high - low <= 0.2 * largest(); }
};

/// The ticks that decide about a controller: those that depend on nothing but inputs in the log. The others follow the
/// log's beginning, which may be the middle of a run, or a missing input, within the controller's memory.
///
/// The differences are those of certain ticks alone.
struct LogStretches : Differences {
  std::optional<std::int64_t> memory;           // [ticks]; none: a limit wasn't found
  std::int64_t compared = 0;                    // certain ticks that were compared
  std::int64_t different = 0;                   // of them, beyond a tolerance
  double beyond_at = 0.0;                       // the time of `beyond` in the log, from the first tick on [s]
  std::optional<std::int64_t> first_uncertain;  // the first tick beyond its tolerance that isn't certain
  std::optional<LogRest> rest;                  // the differences from it on
  /// The differences are none of a state that the log lacks (log_memory.h): `beyond` is the first of all ticks.
  bool is_no_state = false;
};

/// A change of the joystick; controls by their names in scenarios.
struct JoystickMove {
  double at = 0.0;  // [s]
  std::vector<std::pair<std::string, float>> axes;
  std::vector<std::pair<std::string, bool>> buttons;
};

/// The beginning of a log's run, and the moves of the joystick.
struct LogStart {
  struct Root {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // [m]
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  };
  std::optional<Root> root;    // none: the map has no source for it
  std::vector<double> joints;  // displacements by joint id [rad] or [m]; 0 or a limit for joints without a source
  bool has_joystick = false;
  std::vector<JoystickMove> joystick;  // the first moves, as many as a scenario may have
  std::int64_t moves_left_out = 0;
};

/// Differences from the log's commands, in the order of ticks.
struct LogReplayReport : Differences {
  std::int64_t ticks = 0;
  double duration = 0.0;   // [s]
  std::int64_t start = 0;  // the log's time of the first tick [ns]
  double begins = 0.0;     // the same, from the log's first message on [s]
  std::string log_hash;    // of the log's bytes, 16 hexadecimal digits
  std::vector<LogTopicReport> topics;
  std::vector<ControlTimes> control_times;  // of the controller
  bool has_commands = false;                // the map names topics with commands to compare
  std::int64_t ticks_compared = 0;
  std::int64_t ticks_different = 0;
  std::int64_t ticks_beyond = 0;  // of them, beyond a tolerance
  double beyond_at = 0.0;         // the log's time of the first of them, from the first tick on [s]
  /// Commands of the log after the last tick, in ticks: it has no inputs for them.
  std::int64_t ticks_without_inputs = 0;
  double inputs_end = 0.0;  // the time of the last tick, if there are such commands [s]
  /// Ticks between the first and the last command of the log whose message is missing.
  std::int64_t ticks_without_message = 0;
  /// Ticks that have their message, between the first and the last command of the log, for which it has no command.
  std::int64_t ticks_without_command = 0;
  /// Ticks that differ after a missing or late message, before five ticks in a row agree again. They aren't in
  /// ticks_different: the message may be an input, or a controller with a state may need time. More than a hundred in a
  /// row are different.
  std::int64_t ticks_in_doubt = 0;
  std::optional<LogTiming> timing;  // set if commands differ, and the time explains it
  /// Set if commands are beyond their tolerance, and no shift explains it.
  std::optional<LogStretches> certain;
  std::optional<LogCause> cause;      // set if certain commands differ, or too few are certain, and a cause was found
  std::optional<LogTickReport> tick;  // none: the ticks are a grid
  LogStart begin;
  double time_step = 0.0;             // of the controller [s]
  std::string body;                   // the robot's name in channels
  MappedController controller;        // the map's settings of the controller
  int channels = 0;                   // of the trace
  std::int64_t pictures = 0;          // of colour and of depth, in the trace
  std::uintmax_t bytes = 0;           // size of the trace
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung; the replay ended there
  bool controller_refused = false;    // it returned false from configure, initialize or start
  /// Misbehaviour of controllers, and faults of the log.
  Diagnostics remarks;
  /// Of the controllers that start at `restart:` of the map, each with a recording of its own.
  std::vector<LogReplayReport> after_restarts;
  std::filesystem::path trace;

  bool equal() const { return !first && within(); }
  bool within() const { return !failure && agrees() && is_mostly_certain(); }
  /// No certain tick differs, but too few ticks are certain; or the log agrees if it is read in another way.
  bool undecided() const { return !failure && !within() && (agrees() || cause || is_at_neighbours()); }
  /// No tick, or no certain tick, is beyond its tolerance.
  bool agrees() const { return !beyond || (certain && !certain->beyond); }
  /// Certain ticks are at least half of those for which the log has a command.
  bool is_mostly_certain() const {
    return 2 * (beyond && certain ? certain->compared : ticks_compared) >= ticks_compared + ticks_without_inputs;
  }
  bool is_at_neighbours() const { return timing && !timing->shift; }
  /// The differences that a verdict names: those of certain ticks if they were looked for; none if it is undecided.
  const Differences* named() const {
    if (undecided()) return nullptr;
    return certain ? static_cast<const Differences*>(&*certain) : this;
  }
  std::int64_t ticks_unknown() const { return ticks_without_message + ticks_without_command + ticks_in_doubt; }
};

/// Replays a log and writes the trace. Fails, and writes nothing, if the replay can't begin. Reasons are a log without
/// messages, a map that doesn't fit the log or the model, or a controller that reads inputs without a source in the
/// map.
Result<LogReplayReport> replay_log(const std::filesystem::path& log, const std::filesystem::path& trace,
                                   const LogReplayOptions& options);

}  // namespace rehearse
