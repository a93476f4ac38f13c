// LogSurvey: a first pass over a log: which messages the sources of a map have, and from when to when. The second pass,
// which feeds them, then knows where the first tick is and how late a message may come.
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
#include "trace/ros2msg.h"

namespace rehearse {

/// One source of a map, whatever it feeds. One of the pointers is set.
struct MappedSource {
  const LogSource* source = nullptr;  // never null
  std::string use;                    // "joints", the names of devices, "commands"
  const JointSource* joints = nullptr;
  const DeviceSource* devices = nullptr;
  const JoySource* joystick = nullptr;
  const RootSource* root = nullptr;
  const CommandSource* commands = nullptr;

  /// The first tick waits for it: a joystick speaks when it is touched, and the others are no inputs.
  bool is_awaited() const { return joints || root || (devices && devices->kind != DeviceSource::Kind::camera_info); }
};

/// In the map's order; they point into it.
std::vector<MappedSource> sources_of(const LogMap& map, const Model& model);

/// When a message counts, by the map's clock.
class LogTimes {
 public:
  LogTimes(const mcap::Reader& log, LogClock clock);
  ~LogTimes();
  /// [ns]; nullopt if the message has no such time: its header can't be read, or its time is beyond all calendars.
  std::optional<std::int64_t> of(const mcap::Message& message);

 private:
  struct Stamps;
  const mcap::Reader& log_;
  LogClock clock_;
  std::map<std::uint16_t, std::unique_ptr<Stamps>> stamps_;  // by channel id
};

/// Which quantities of a joint a log gives.
struct GivenJoint {
  bool q = false, dq = false, u = false;
};

struct SourceSurvey {
  std::int64_t messages = 0;
  std::int64_t out_of_order = 0;         // in the file behind one of a later log time
  std::int64_t without_time = 0;         // not counted among the messages that are used
  std::optional<std::int64_t> first;     // [ns]
  std::optional<std::int64_t> complete;  // of joints: when each had a message [ns]; else first
  std::int64_t last = 0;                 // [ns]
  std::map<int, GivenJoint> joints;      // by id
  std::set<std::string> strangers;       // names of joints that aren't the model's
};

struct LogSurvey {
  std::vector<SourceSurvey> sources;  // parallel to those of the map
  std::int64_t latest = 0;            // how much later than its time a message may be logged [ns]
  CommandedJoints largest_commands;   // magnitudes, if a tolerance of the map is relative; else empty
  Diagnostics damage;                 // what isn't whole of the log
};

/// Channels of the log by the topics of the sources.
std::vector<std::uint16_t> channels_of(const mcap::Reader& log, const std::vector<MappedSource>& sources);

/// Messages of whatever topic in order of log time, those of `channels` only. A log that isn't whole is read as far as
/// it goes; what isn't whole comes back.
Diagnostics read_in_order(mcap::Reader& log, const std::vector<std::uint16_t>& channels,
                          const std::function<bool(const mcap::Message&)>& callback);

LogSurvey survey(mcap::Reader& log, const LogMap& map, const Model& model, const std::vector<MappedSource>& sources);

}  // namespace rehearse
