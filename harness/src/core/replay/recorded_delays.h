// RecordedDelays: the time at which the commands of a recording act, tick by tick: one tick late, or in the same tick
// (no-delay mode). It is compared with the mode of the controllers that replay the recording.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/host/controller_host.h"

namespace rehearse {

class RecordedDelays {
 public:
  /// Finds the channels. The controllers must have started, and the host must outlive this.
  RecordedDelays(const ControllerHost& host, const mcap::Reader& recording);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  /// Takes a message of one of channels(), in the tick that is compared next.
  void accept(const mcap::Message& message);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Calls `differs` for each controller whose commands begin, in this tick, to act at a different time than the
  /// recorded commands. The caller fills in tick and time.
  void compare(const OnDifference& differs);

 private:
  /// The commands of a controller; commands to devices aren't among them, because they act after the step in any mode.
  struct Commands {
    const HostedController* hosted;
    std::string topic = {};  // the first channel of its commands
    bool delayed = true;     // as the channel states
    /// The channel with a message in each tick in which the mode is the other one; none: there is no such tick.
    std::optional<std::uint16_t> channel = std::nullopt;
    bool is_other_mode = false;  // in this tick
    bool differs = false;        // in the last tick
  };

  std::vector<Commands> all_;
  std::vector<std::uint16_t> channels_;
};

}  // namespace rehearse
