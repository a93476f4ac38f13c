// RecordedWords: the lines to os() and the variables that the controllers of a recording wrote. They are compared with
// the lines and variables of the replay.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/hashing.h"
#include "core/host/controller_host.h"

namespace rehearse {

class RecordedWords {
 public:
  /// Finds the channels. The host must outlive this.
  RecordedWords(const ControllerHost& host, const mcap::Reader& trace);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  /// Takes a message of one of channels(). An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);
  /// Takes the host's events of the replay.
  void say(const std::vector<msg::Event>& events);

  using OnDifference = std::function<void(Divergence&&)>;
  /// Begins a tick, whose messages have been accepted since the last call; its controllers run after this call. Lines
  /// between two ticks belong to the earlier tick: calls `differs` with the first different line of that tick.
  void begin_tick(const OnDifference& differs);
  /// Compares the lines of the last tick in the same way.
  void end(const OnDifference& differs);
  using OnVariable =
      std::function<void(const std::string& topic, std::optional<double> recorded, std::optional<double> now)>;
  /// Calls `compare` for each variable of this tick. Returns their number.
  std::int64_t compare_variables(const OnVariable& compare) const;
  /// Number of lines compared so far.
  std::int64_t lines() const { return lines_; }
  /// True if all events of the host and its controllers so far, with tick and severity, are the recorded events.
  bool same_events() const { return recorded_events_.value() == said_events_.value(); }

 private:
  struct Variable {
    std::string topic;
    std::optional<double> value;      // last value in the messages since begin_tick()
    std::optional<double> this_tick;  // recorded value in the tick whose controllers run
  };
  using Lines = std::vector<std::string>;  // elements as "SR1/Walker: text"
  bool is_line(const msg::Event& event) const;

  const ControllerHost& host_;
  std::vector<std::uint16_t> channels_;
  std::uint16_t events_channel_ = 0;
  std::map<std::uint16_t, Variable> variables_;  // by channel id
  bool begun_ = false;
  Lines coming_, recorded_, said_;
  std::int64_t lines_ = 0;
  RunningHash recorded_events_, said_events_;
};

}  // namespace rehearse
