// LogCommands: the commands of the robot's own controller, for comparison with those of the present controller.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "command_ranges.h"
#include "command_timing.h"
#include "core/compare/row_judge.h"
#include "core/host/controller_host.h"
#include "core/ros2msg/ros2msg.h"
#include "log_feed.h"
#include "log_ticks.h"

namespace rehearse {

/// Decodes the messages of a map's commands.
class CommandReader {
 public:
  /// All except the schema must outlive this.
  CommandReader(const LogMap& map, const Model& model, const ros2msg::Schema& schema);
  ~CommandReader();

  /// Fails with the reason if the message can't be read.
  Result<CommandedJoints> read(mcap::Bytes payload);

 private:
  struct Readers;
  Result<void> read_states(mcap::Bytes payload, CommandedJoints& joints);
  Result<void> read_array(mcap::Bytes payload, CommandedJoints& joints);

  const CommandSource& source_;
  const std::size_t joints_;  // of the model
  std::unique_ptr<Readers> readers_;
};

/// The member for a command field; null: the field isn't q, dq or u of a joint.
std::optional<double> CommandedJoint::*commanded_part(const IoField& field);

/// Raises the magnitudes in `largest` to those of `joints` where these are larger; ignores numbers that aren't finite.
void keep_largest(CommandedJoints& largest, const CommandedJoints& joints);

/// Facts of a whole log for the comparison of its commands.
struct CommandFacts {
  CommandedJoints largest;  // magnitudes, to which relative tolerances refer; empty if there are none
  CommandRanges ranges;     // for default tolerances
  std::int64_t messages = 0;
  std::int64_t first = 0;    // time of the first message [ns]
  std::int64_t last = 0;     // time of the last message [ns]
  std::int64_t latency = 0;  // usual time from the message that makes a tick to its command [ns]; on a grid unused
};

class LogCommands {
 public:
  /// All except schema and facts must outlive this.
  LogCommands(const LogMap& map, const Model& model, const ros2msg::Schema& schema, const LogTicks& ticks,
              CommandFacts facts)
      : model_(model),
        ticks_(ticks),
        facts_(std::move(facts)),
        shift_(map.commands->shift),
        takes_last_(map.take == TakenCommand::last),
        zeros_are_foreign_(map.zeros_are_foreign),
        limits_(map.limits),
        map_rules_(map.tolerances),
        reader_(map, model, schema) {}

  /// Adds the next message; it must not be earlier than the one before it. Fails with the reason if it can't be read.
  Result<void> take(std::int64_t time, mcap::Bytes payload);

  /// True if at least three of four ticks have a command. Then a tick without a command lacks a message.
  bool come_each_tick() const { return 4 * facts_.messages >= 3 * ticks_.size(); }
  /// True if the tick is neither before the first message nor after the last one.
  bool covers(std::int64_t tick) const;
  /// The commands of a tick, not before those that were read last; earlier ones are dropped. Null: no message can be
  /// attributed to the tick. On a grid it is the last message from the tick until the next. If ticks are messages, it
  /// is the first one in this time that isn't later than usual by half a time step.
  const CommandedJoints* of_tick(std::int64_t tick);

  /// The tolerance of each number of the controllers that the log has, by its range if the map states none.
  std::vector<ToleranceRule> tolerances(const ControllerHost& host) const;
  /// The numbers whose tolerance is half a step, as "PAN/u: 0.01 N·m".
  std::vector<std::string> steps(const ControllerHost& host) const;
  /// A judge for the commands of the controllers, which this must outlive.
  std::unique_ptr<RowJudge> make_judge(const ControllerHost& host, double time_step, RowJudge::OnDifference differs);
  /// The numbers that compare() returns.
  const std::vector<CommandColumn>& columns() const { return columns_; }
  /// Passes the commands of the controllers in a tick, and those of the log, to the judge that make_judge() made.
  /// Returns all numbers of the controllers, in the same order each time.
  std::vector<CommandPair> compare(std::int64_t tick, const CommandedJoints& logged, const ControllerHost& host,
                                   RowJudge& judge) const;
  /// Passes the log's commands of a tick that isn't compared to the judge, for commands that come late.
  static void pass_over(std::int64_t tick, const CommandedJoints& logged, const ControllerHost& host, RowJudge& judge);

 private:
  /// A number that a controller commands.
  struct Commanded {
    const IoField& field;
    std::optional<double> CommandedJoint::*part;
    std::string topic, element;  // of the controller's channel
    std::string unit;
  };
  std::vector<Commanded> commanded_by(const HostedController& hosted) const;
  ToleranceRule rule_of(const Commanded& number) const;

  struct Sample {
    std::int64_t time = 0;  // [ns]
    CommandedJoints joints;
  };

  const Model& model_;
  const LogTicks& ticks_;
  const CommandFacts facts_;
  const int shift_;
  const bool takes_last_, zeros_are_foreign_;
  const std::map<int, double>& limits_;  // by joint id
  const std::vector<ToleranceRule>& map_rules_;
  CommandReader reader_;
  std::vector<CommandColumn> columns_;
  std::vector<ToleranceRule> rules_;  // one for each number that the controllers command
  std::deque<Sample> samples_;
};

}  // namespace rehearse
