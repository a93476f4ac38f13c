// LogCommands: what the robot's own controller commanded, to be compared with what the controller commands now.
#pragma once

#include <rehearse/divergence.h>
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

class LogCommands {
 public:
  /// All but the schema must outlive this.
  LogCommands(const LogMap& map, const Model& model, const ros2msg::Schema& schema);
  ~LogCommands();

  /// The next message; not earlier than the one before it. False: it isn't what its schema says.
  bool take(std::int64_t time, mcap::Bytes payload);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Compares what the controllers command in a tick with the latest message from `from` up to, and not including,
  /// `until` [ns]; earlier messages are forgotten. Calls `differs` for each number that isn't the same bits; tick and
  /// time are the caller's to fill in. Returns how many numbers were compared.
  std::int64_t compare(std::int64_t from, std::int64_t until, const ControllerHost& host, const Scenario& scenario,
                       const OnDifference& differs);

 private:
  struct Readers;
  /// What a message commands of a joint.
  struct Commanded {
    std::optional<double> q, dq, u;
  };
  struct Sample {
    std::int64_t time = 0;          // [ns]
    std::vector<Commanded> joints;  // by joint id
  };

  bool take_states(mcap::Bytes payload, Sample& sample);
  bool take_array(mcap::Bytes payload, Sample& sample);

  const LogMap& map_;
  const Model& model_;
  std::unique_ptr<Readers> readers_;
  std::deque<Sample> samples_;
};

}  // namespace rehearse
