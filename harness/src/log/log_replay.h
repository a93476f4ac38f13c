// Log replay: what a real robot sent, into a controller, without physics. A log is a ROS 2 bag (MCAP, cdr); a map, a
// YAML file described in fixtures/README.md, says which topic is which input.
//
// What comes out is an ordinary recording: the inputs that the controller saw at its own ticks, and what it commanded.
// It is replayed (replay.h), compared and kept as a golden like any other; it has no physics to repeat. Links neither
// ODE nor OSMesa.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

struct LogReplayOptions : HostOptions {
  std::string controller;       // the library, a name or a path
  std::filesystem::path model;  // the robot, a URDF file
  std::filesystem::path map;    // which topic is which input
  double from = 0.0;            // commands before it are not compared [s]
  std::optional<double> until;  // the replay ends there [s]
  /// Called with each difference from the log's commands, in the order of ticks; null: not.
  std::function<void(const Divergence&)> on_difference;
  /// Called about every hundredth of the log with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// How a topic of the log served the replay. Times are seconds from the first tick on; what came before is negative.
struct LogTopicReport {
  std::string topic;
  std::string type;           // sensor_msgs/msg/Imu
  std::string use;            // "joints", "WaistIMU", "commands"
  std::int64_t messages = 0;  // in the log
  std::int64_t used = 0;      // that some tick saw
  std::int64_t skipped =
      0;  // that came and were replaced between two ticks, or came before the first or after the last
  std::int64_t out_of_order = 0;   // that stand in the file behind messages of a later log time
  std::int64_t same_stamp = 0;     // with the time of the one before them
  std::int64_t backwards = 0;      // with an earlier time than the one before them; they are not used
  std::int64_t unreadable = 0;     // that aren't what their schema says; they are not used
  double rate = 0.0;               // messages a second, over all of them; 0 for fewer than two
  double longest_gap = 0.0;        // between two messages [s]
  double longest_gap_at = 0.0;     // where it begins [s]
  double worst_age = 0.0;          // of what a tick saw [s]
  double worst_age_at = 0.0;       // that tick's time [s]
  std::int64_t gaps = 0;           // how often it became older than the map allows
  std::int64_t ticks_in_gaps = 0;  // ticks that saw something older; the last value is held
  std::int64_t ticks_without = 0;  // ticks before its first message
};

/// Differences from the log's commands, in the order of ticks.
struct LogReplayReport : Differences {
  std::int64_t ticks = 0;
  double duration = 0.0;   // [s]
  std::int64_t start = 0;  // the log's time of the first tick [ns]
  std::string log_hash;    // of the log's bytes, 16 hexadecimal digits
  std::vector<LogTopicReport> topics;
  bool has_commands = false;  // the map names commands to compare with
  std::int64_t ticks_compared = 0;
  std::int64_t ticks_different = 0;
  int channels = 0;                   // of the trace
  std::int64_t frames = 0;            // colour pictures in it
  std::uintmax_t bytes = 0;           // of it
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung; the replay ended there
  bool controller_refused = false;    // it returned false from configure, initialize or start
  Diagnostics remarks;                // what controllers did that they should not have, and what is wrong with the log

  bool equal() const { return !first && !failure; }
  bool within() const { return !beyond && !failure; }
};

/// Replays a log and writes the trace. Fails, with nothing written, if it can't begin: a log without messages, a map
/// that doesn't fit it or the model, a controller that reads what the map doesn't give.
Result<LogReplayReport> replay_log(const std::filesystem::path& log, const std::filesystem::path& trace,
                                   const LogReplayOptions& options);

}  // namespace rehearse
