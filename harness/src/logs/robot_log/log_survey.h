// LogSurvey: a first pass over a log. It finds the messages of a map's sources, and their first and last times. So the
// second pass, which feeds the messages, has the time of the first tick and the largest delay of a message.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/ros2msg/ros2msg.h"
#include "log_clocks.h"
#include "log_commands.h"
#include "log_ticks.h"
#include "logs/map/log_map.h"

namespace rehearse {

/// The quantities of a joint in a log.
struct GivenJoint {
  bool q = false, dq = false, u = false;
};

/// Some displacements of a joint, as they are in messages.
class JointPositions {
 public:
  void add(double number) {
    constexpr std::size_t most = 2048;
    if (numbers_.size() < most && std::isfinite(number)) numbers_.push_back(number);
  }
  /// The step of which all are multiples; 0: there is none [rad] or [m].
  double step() const {
    std::vector<double> rising = numbers_;
    std::ranges::stable_sort(rising);
    return step_of(rising);
  }

 private:
  std::vector<double> numbers_;
};

struct SourceSurvey {
  std::int64_t messages = 0;
  std::int64_t out_of_order = 0;  // messages after one of a later log time in the file
  std::int64_t backwards = 0;     // messages with an earlier time than the one before
  std::int64_t twins = 0;         // messages that were recorded before; not counted as messages
  std::int64_t without_time = 0;  // not counted as used messages
  std::vector<LogUnreadable>
      timeless;  // the reasons; first_at is the log's time of the message, or of the one before [s]
  std::optional<std::int64_t> first;        // [ns]
  std::optional<std::int64_t> complete;     // for joints: the time when each had a message [ns]; else first
  std::int64_t last = 0;                    // [ns]
  std::uint64_t last_logged = 0;            // log time of the last message [ns]
  std::int64_t first_delay = 0;             // from the time of the first message to its log time [ns]
  std::map<int, GivenJoint> joints;         // by id; also those of commands
  std::map<int, JointPositions> positions;  // by id
  std::map<std::string, int> names;         // joint ids by the log's names; -1: the model has no such joint
  std::set<std::string> repeated;           // names that a message has twice
  std::optional<Diagnostic> unreadable;  // why the first of the decoded messages can't be read; none: one can be read
  DurationCounts intervals;              // between messages
  DurationCounts before_commands;        // from the last message to each command
};

struct LogSurvey {
  std::vector<SourceSurvey> sources;  // parallel to those of the map
  /// Times of the messages that make ticks [ns], rising; messages with the same time count once. Empty: ticks are a
  /// grid.
  std::vector<std::int64_t> tick_messages;
  DurationCounts latencies;          // of commands after the last tick's message, if there are any
  std::int64_t latest = 0;           // largest delay of a message's log time after its time [ns]
  CommandedJoints largest_commands;  // magnitudes, if a tolerance of the map is relative; else empty
  CommandRanges ranges;              // of the commands
  Diagnostics damage;                // damage of the log
};

LogSurvey survey(mcap::Reader& log, const LogMap& map, const Model& model, const std::vector<MappedSource>& sources,
                 LogTimes& times);

}  // namespace rehearse
