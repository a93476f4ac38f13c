// TickPlan: the times of a map's ticks relative to the messages of their topic.
//
// Ticks are the messages, or a grid at their regular times. Ticks of a topic of commands are earlier by the latency of
// the controller. If the map doesn't state it, each tick is half-way between the last message of an input and the
// command. Then the input is read in the right tick whatever the jitter of both, up to half of the time between them.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <string>
#include <vector>

#include "log_replay.h"
#include "log_survey.h"
#include "log_ticks.h"
#include "logs/map/log_map.h"

namespace rehearse {

class TickPlan {
 public:
  /// Fails if the latency has to be measured, and no input comes at a regular time before the commands.
  static Result<TickPlan> make(const LogMap& map, const std::vector<MappedSource>& sources, const LogSurvey& survey);

  /// The ticks from `start` [ns] on; none if no message is left.
  LogTicks ticks(const std::vector<std::int64_t>& messages, std::int64_t start) const;

  /// The time around a tick in which a message of the topic may have been read in the tick before or after.
  TickWindow window_of(const std::string& topic) const;
  /// The usual time from a tick to its command [ns].
  std::int64_t latency() const { return latency_; }
  LogTickReport report() const;

 private:
  explicit TickPlan(const LogMap& map)
      : tick_(*map.tick), time_step_(map.time_step), skips_missing_(map.skips_missing) {}
  /// The input with the most regular time to the next command; -1: none is regular.
  static int steadiest_input(const std::vector<MappedSource>& sources, const LogSurvey& survey);

  const TickSource& tick_;
  double time_step_;
  bool skips_missing_;
  RegularTimes regular_;
  std::int64_t shift_ = 0;    // of the ticks after the messages [ns]
  std::int64_t latency_ = 0;  // [ns]
  std::string trigger_;       // topic of the input from which the latency was measured, or of the grid
  TickWindow of_trigger_, of_others_;
};

}  // namespace rehearse
