// LogCommands: the commands of the robot's own controller, for comparison with those of the present controller.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/controller_host.h"
#include "log_feed.h"
#include "trace/ros2msg.h"

namespace rehearse {

/// The command of a message for a joint.
struct CommandedJoint {
  std::optional<double> q, dq, u;
};
using CommandedJoints = std::vector<CommandedJoint>;  // by joint id

/// Decodes the messages of a map's commands.
class CommandReader {
 public:
  /// All except the schema must outlive this.
  CommandReader(const LogMap& map, const Model& model, const ros2msg::Schema& schema);
  ~CommandReader();

  /// Nullopt: the message doesn't fit its schema.
  std::optional<CommandedJoints> read(mcap::Bytes payload);

 private:
  struct Readers;
  bool read_states(mcap::Bytes payload, CommandedJoints& joints);
  bool read_array(mcap::Bytes payload, CommandedJoints& joints);

  const CommandSource& source_;
  const std::size_t joints_;  // of the model
  std::unique_ptr<Readers> readers_;
};

/// Keeps the larger magnitudes of both; numbers that aren't finite are ignored.
void keep_largest(CommandedJoints& largest, const CommandedJoints& joints);

class LogCommands {
 public:
  /// All except the schema must outlive this. `largest`: magnitudes in the whole log, to which relative tolerances
  /// refer; empty if there are none.
  LogCommands(const LogMap& map, const Model& model, const ros2msg::Schema& schema, const CommandedJoints& largest)
      : model_(model), largest_(largest), reader_(map, model, schema) {}

  /// Adds the next message; it must not be earlier than the one before it. False: it doesn't fit its schema.
  bool take(std::int64_t time, mcap::Bytes payload);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Compares the commands of the controllers in a tick with the latest message from `from` up to, and not including,
  /// `until` [ns]; earlier messages are dropped. Calls `differs` for each number with different bits; the caller sets
  /// tick and time. Returns the number of compared numbers.
  std::int64_t compare(std::int64_t from, std::int64_t until, const ControllerHost& host, const Scenario& scenario,
                       const OnDifference& differs);

 private:
  struct Sample {
    std::int64_t time = 0;  // [ns]
    CommandedJoints joints;
  };

  const Model& model_;
  const CommandedJoints& largest_;
  CommandReader reader_;
  std::deque<Sample> samples_;
};

}  // namespace rehearse
