// LogObservations: observations from the messages of a log, by a feed for each source of its map.
#pragma once

#include <rehearse/model.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/run/run.h"
#include "log_commands.h"
#include "log_feed.h"
#include "log_replay.h"
#include "log_states.h"
#include "log_survey.h"
#include "log_tick_plan.h"
#include "order_watch.h"
#include "topic_watch.h"

namespace rehearse {

class LogObservations final : public ObservationSource {
 public:
  /// All arguments must outlive this. Null `plan`: ticks are the nominal grid.
  LogObservations(const LogMap& map, const Model& model, const std::vector<MappedSource>& sources,
                  const LogSurvey& survey, const LogTicks& ticks, const TickPlan* plan)
      : map_(map), model_(model), sources_(sources), survey_(survey), ticks_(ticks), plan_(plan) {}

  Result<void> make_feeds(const std::vector<LogTopic>& topics);
  /// Before make_feeds(): moves displacements of joints up or down, by joint id.
  void move_positions(std::map<int, double> half_steps) { half_steps_ = std::move(half_steps); }
  /// From now on also looks for messages that the controller may have had at another time, or in another order.
  void watch_order(LogTimes& times);
  /// A tick may need messages that are later than it by less than this [ns].
  std::int64_t lookahead() const { return lookahead_; }
  const LogTicks& ticks() const { return ticks_; }
  /// True if the controller may have had another message in the last tick. Either one is missing in the log, or one
  /// came so near to the tick that it may belong to the tick before or after.
  bool may_miss_input() const;
  /// True if a message of an input, or of the commands, near the last tick was late, came twice, or isn't in order;
  /// always false without watch_order().
  bool doubts_inputs() const { return doubts_inputs_; }
  bool doubts_commands() const { return doubts_commands_; }

  /// True if each tick is a message that has all inputs and a stamp: at distances of up to one and a half steps none is
  /// missing.
  bool ticks_are_inputs() const { return ticks_are_inputs_; }
  /// A clock of the log steps, so that distances of ticks do say something.
  void doubt_distances() { ticks_are_inputs_ = false; }

  /// Adds the next message in the order of the log, with its time [ns].
  void take(std::int64_t time, const mcap::Message& message);
  /// The commands of the robot's own controller; null: the map states none.
  LogCommands* commands() { return commands_.get(); }
  /// The state that the robot's controller published between the tick before and this one; needs watch_order().
  std::optional<std::map<std::string, double>> state_before(std::int64_t tick);
  /// The robot at the last tick.
  const Observation& seen() const { return seen_; }

  /// The robot at tick 0; NaN for joints without a source.
  const BodyObservation& look_first();
  /// Sets the displacements of those joints [rad] or [m], by joint id.
  void complete_posture(const std::vector<double>& joints);
  /// The sources that have had messages, none of which can be read.
  Diagnostics unreadable_sources() const;
  Diagnostics take_remarks();

  Result<bool> observe(TickData& now) override;
  Result<bool> advance(TickData& now, Commander& commands) override;

  /// The use of the messages of each source so far: all members except names and facts of the whole log.
  std::vector<LogTopicReport> report() const;

 private:
  /// A source with its feed.
  struct Fed {
    const MappedSource& mapped;
    std::unique_ptr<LogFeed> feed;  // null: a source of commands
    TopicWatch watch;
    std::optional<OrderWatch> order = {};
    std::vector<LogUnreadable> unreadable_for = {};
    std::optional<Diagnostic> unreadable_first = {};
    std::int64_t readable = 0;
    std::int64_t gap_events = 0;
  };
  bool has_position(int joint) const;
  void look(std::int64_t tick);
  void reject(Fed& fed, std::int64_t time, const Diagnostic& reason);
  void add_gap_event(Fed& fed, std::int64_t tick, std::string what);
  void place_links();

  const LogMap& map_;
  const Model& model_;
  const std::vector<MappedSource>& sources_;
  const LogSurvey& survey_;
  const LogTicks& ticks_;
  const TickPlan* plan_;
  std::vector<Fed> fed_;  // parallel to sources_
  std::unique_ptr<LogCommands> commands_;
  std::unique_ptr<LogStates> states_;  // null: the map has none
  std::int64_t lookahead_ = 0;         // [ns]
  LogTimes* times_ = nullptr;          // null: the order isn't watched
  bool doubts_inputs_ = false, doubts_commands_ = false;
  bool ticks_are_inputs_ = false;
  std::map<int, double> half_steps_;
  Observation seen_;
  std::vector<msg::Event> gap_events_;
};

}  // namespace rehearse
