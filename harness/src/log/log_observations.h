// LogObservations: observations from the messages of a log, by a feed for each source of its map.
#pragma once

#include <rehearse/model.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "log_commands.h"
#include "log_feed.h"
#include "log_replay.h"
#include "log_survey.h"
#include "run/run.h"
#include "topic_watch.h"

namespace rehearse {

class LogObservations final : public ObservationSource {
 public:
  /// All arguments must outlive this.
  LogObservations(const LogMap& map, const Model& model, const std::vector<MappedSource>& sources,
                  const LogSurvey& survey, const LogTicks& ticks)
      : map_(map), model_(model), sources_(sources), survey_(survey), ticks_(ticks) {}

  Result<void> make_feeds(const std::vector<LogTopic>& topics);
  /// A tick may need messages that are later than it by less than this [ns].
  std::int64_t lookahead() const { return lookahead_; }
  const LogTicks& ticks() const { return ticks_; }
  /// True if a message that a controller could have had in the last tick may be missing in the log.
  bool may_miss_input() const;

  /// Adds the next message in the order of the log, with its time [ns].
  void take(std::int64_t time, const mcap::Message& message);
  /// The commands of the robot's own controller; null: the map states none.
  LogCommands* commands() { return commands_.get(); }

  /// The robot at tick 0; NaN for joints without a source.
  Result<const BodyObservation*> look_first();
  /// Sets the displacements of those joints [rad] or [m], by joint id.
  void complete_posture(const std::vector<double>& joints);
  Diagnostics take_remarks();

  Result<bool> observe(Moment& now) override;
  Result<bool> advance(Moment& now, Commander& commands) override;

  /// The use of the messages of each source so far: all members except names and facts of the whole log.
  std::vector<LogTopicReport> report() const;

 private:
  /// A source with its feed.
  struct Fed {
    const MappedSource& mapped;
    std::unique_ptr<LogFeed> feed;  // null: a source of commands
    TopicWatch watch;
    std::int64_t unreadable = 0;
    std::int64_t gap_events = 0;
  };
  Result<void> look(std::int64_t tick);
  void add_gap_event(Fed& fed, std::int64_t tick);
  void place_links();

  const LogMap& map_;
  const Model& model_;
  const std::vector<MappedSource>& sources_;
  const LogSurvey& survey_;
  const LogTicks& ticks_;
  std::vector<Fed> fed_;  // parallel to sources_
  std::unique_ptr<LogCommands> commands_;
  std::int64_t lookahead_ = 0;  // [ns]
  Observation seen_;
  std::vector<msg::Event> gap_events_;
};

}  // namespace rehearse
