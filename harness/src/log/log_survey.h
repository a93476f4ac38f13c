// LogSurvey: a first pass over a log. It finds the messages of a map's sources, and their first and last times. So the
// second pass, which feeds the messages, has the time of the first tick and the largest delay of a message.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "log_commands.h"
#include "log_map/log_map.h"
#include "log_ticks.h"
#include "trace/ros2msg.h"

namespace rehearse {

/// One source of a map of any kind. One of the pointers is set, except for a topic that only makes ticks.
struct MappedSource {
  const LogSource* source = nullptr;  // never null
  std::string use;                    // "joints", the names of devices, "commands"
  const JointSource* joints = nullptr;
  const DeviceSource* devices = nullptr;
  const JoySource* joystick = nullptr;
  const RootSource* root = nullptr;
  const CommandSource* commands = nullptr;

  /// True if the first tick waits for it: a joystick sends only when it is moved, and commands and camera infos are no
  /// inputs.
  bool is_awaited() const { return joints || root || (devices && devices->kind != DeviceSource::Kind::camera_info); }
};

/// The sources in the map's order; they point into it.
std::vector<MappedSource> sources_of(const LogMap& map, const Model& model);

/// The time of a message on the map's clock.
class LogTimes {
 public:
  LogTimes(const mcap::Reader& log, LogClock clock);
  ~LogTimes();
  /// [ns]; nullopt if the message has no such time: its header can't be read, or its time is out of range.
  std::optional<std::int64_t> of(const mcap::Message& message);

 private:
  struct Stamps;
  const mcap::Reader& log_;
  LogClock clock_;
  std::map<std::uint16_t, std::unique_ptr<Stamps>> stamps_;  // by channel id
};

/// The quantities of a joint in a log.
struct GivenJoint {
  bool q = false, dq = false, u = false;
};

struct SourceSurvey {
  std::int64_t messages = 0;
  std::int64_t out_of_order = 0;         // messages after one of a later log time in the file
  std::int64_t without_time = 0;         // not counted as used messages
  std::optional<std::int64_t> first;     // [ns]
  std::optional<std::int64_t> complete;  // for joints: the time when each had a message [ns]; else first
  std::int64_t last = 0;                 // [ns]
  std::map<int, GivenJoint> joints;      // by id
  std::set<std::string> strangers;       // names of joints that the model doesn't have
  DurationCounts intervals;              // between messages
};

struct LogSurvey {
  std::vector<SourceSurvey> sources;  // parallel to those of the map
  /// Times of the messages that make ticks [ns], rising; of two with the same time one. Empty: ticks are a grid.
  std::vector<std::int64_t> tick_messages;
  DurationCounts latencies;          // of commands after the last tick's message, if there are such
  std::int64_t latest = 0;           // largest delay of a message's log time after its time [ns]
  CommandedJoints largest_commands;  // magnitudes, if a tolerance of the map is relative; else empty
  Diagnostics damage;                // damage of the log
};

/// The channels of the log with the topics of the sources.
std::vector<std::uint16_t> channels_of(const mcap::Reader& log, const std::vector<MappedSource>& sources);

/// Delivers the messages of `channels`, of any topic, in order of log time. A damaged log is read as far as possible;
/// the damage is returned.
Diagnostics read_in_order(mcap::Reader& log, const std::vector<std::uint16_t>& channels,
                          const std::function<bool(const mcap::Message&)>& callback);

LogSurvey survey(mcap::Reader& log, const LogMap& map, const Model& model, const std::vector<MappedSource>& sources);

}  // namespace rehearse
