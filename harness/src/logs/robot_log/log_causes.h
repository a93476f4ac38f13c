// The usual causes for commands that differ although the controller is the robot's: other readings of the log.
// Internal.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "log_clocks.h"
#include "log_replay.h"
#include "log_survey.h"
#include "logs/map/log_map.h"

namespace rehearse {

/// A map that reads a log in another way.
struct OtherReading {
  LogMap map;
  std::vector<std::string> lines;  // that state it in the user's map
  std::string meaning;
  bool has_same_messages = true;     // ticks are at the same topic, and clocks are the same
  std::optional<double> begin = {};  // of the replay, from the first tick on [s]; nullopt: that of the map
};

/// The readings that are worth a try, the most usual first: times by stamps, or by the log; the controller started
/// with another message; it isn't called where messages are missing; it was started again; commands were clipped, or
/// replaced by zeros; a joint has another name later; angles are wrapped, or in degrees; ticks by another topic.
std::vector<OtherReading> other_readings(const LogMap& map, const std::vector<MappedSource>& sources,
                                         const LogSurvey& survey, const std::vector<LogTopic>& topics,
                                         const Model& model, const LogReplayReport& report);

/// The reading in which the last of several commands of a tick is the controller's. None: there is one for each tick.
std::optional<OtherReading> reading_of_last_commands(const LogMap& map, const std::vector<MappedSource>& sources,
                                                     const LogSurvey& survey, const LogReplayReport& report);

/// The reading in which topics of the map have another name from their last messages on: that of a topic of their type
/// that begins there. None: no topic is renamed. `ending`: log time of the log's last message [ns].
std::optional<OtherReading> reading_with_renamed(mcap::Reader& log, const LogMap& map,
                                                 const std::vector<MappedSource>& sources, const LogSurvey& survey,
                                                 const std::vector<LogTopic>& topics, std::int64_t ending);

}  // namespace rehearse
