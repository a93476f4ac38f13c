// LogStates: the states that the robot's controller published, for a controller that takes them by rehearse_state().
// Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ros2msg/ros2msg.h"
#include "logs/map/log_map.h"
#include "number_messages.h"

namespace rehearse {

class LogStates {
 public:
  /// `source` must outlive this.
  LogStates(const StateSource& source, const ros2msg::Schema& schema) : source_(source), reader_(schema) {}

  /// Adds the next message; it must not be earlier than the one before it. Fails with the reason if it can't be read.
  Result<void> take(std::int64_t time, mcap::Bytes payload);
  /// The numbers by name of the only message in that time [ns], `until` not included. Nullopt: there is none, or more
  /// than one, so that it isn't known which call of control() it follows. Times don't fall from call to call.
  std::optional<std::map<std::string, double>> in(std::int64_t from, std::int64_t until);

 private:
  struct Sample {
    std::int64_t time = 0;  // [ns]
    std::vector<double> numbers;
  };

  const StateSource& source_;
  NumberMessages reader_;
  std::deque<Sample> samples_;
};

}  // namespace rehearse
