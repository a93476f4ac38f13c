// LogObservations: what is observed comes from the messages of a log, by way of a feed for each source of its map.
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
  /// `start`: the time of tick 0 [ns]. All must outlive this.
  LogObservations(const LogMap& map, const Model& model, const std::vector<MappedSource>& sources,
                  const LogSurvey& survey, std::int64_t start)
      : map_(map), model_(model), sources_(sources), survey_(survey), start_(start) {}

  Result<void> make_feeds(const std::vector<LogTopic>& topics);
  /// A message behind a tick by less than this may still matter to it [ns].
  std::int64_t lookahead() const { return lookahead_; }
  std::int64_t time_of_tick(std::int64_t tick) const;  // of the log [ns]

  /// The next message in the order of the log, and its time [ns].
  void take(std::int64_t time, const mcap::Message& message);
  /// What the robot's own controller commanded; null: the map doesn't say.
  LogCommands* commands() { return commands_.get(); }

  /// The robot at tick 0; NaN for joints that nothing gives.
  Result<const BodyObservation*> look_first();
  /// Where those joints are [rad] or [m], by joint id.
  void complete_posture(const std::vector<double>& joints);
  Diagnostics take_remarks();

  Result<bool> observe(Moment& now) override;
  Result<bool> advance(Moment& now, Commander& commands) override;

  /// What became of the messages of each source so far: all but names and what the whole log has.
  std::vector<LogTopicReport> report() const;

 private:
  /// A source while it is fed.
  struct Fed {
    const MappedSource& mapped;
    std::unique_ptr<LogFeed> feed;  // null: of commands
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
  const std::int64_t start_;  // [ns]
  std::vector<Fed> fed_;      // parallel to sources_
  std::unique_ptr<LogCommands> commands_;
  std::int64_t lookahead_ = 0;  // [ns]
  Observation seen_;
  std::vector<msg::Event> gap_events_;
};

}  // namespace rehearse
