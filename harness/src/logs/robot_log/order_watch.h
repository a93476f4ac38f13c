// OrderWatch: finds the messages of a topic that the controller may have had at another time, or in another order, than
// the log states. Internal.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <deque>
#include <optional>

#include "log_ticks.h"

namespace rehearse {

class OrderWatch {
 public:
  /// `time_step` [s] of the controller.
  explicit OrderWatch(double time_step);

  /// The next message in the order of log time. `stamp`: its header.stamp [ns]; none: unknown.
  void add(const mcap::Message& message, std::optional<std::int64_t> stamp);
  /// True if a message that was logged near that time [ns] was late, came twice, or isn't in order. Times don't fall.
  bool doubts(std::int64_t time);

 private:
  struct Span {
    std::int64_t from, until;  // [ns]
  };

  const std::int64_t step_;  // [ns]
  std::optional<mcap::Location> place_;
  std::optional<std::int64_t> stamp_, delay_;  // of the message before [ns]
  DurationCounts changes_{8};                  // of the delay
  std::deque<Span> spans_;
};

}  // namespace rehearse
