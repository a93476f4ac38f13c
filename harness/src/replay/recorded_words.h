// RecordedWords: what the controllers of a recording said beside their commands, lines to os() and variables, to be
// compared with what they say now.
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

#include "host/controller_host.h"
#include "trace/hashing.h"

namespace rehearse {

class RecordedWords {
 public:
  /// Finds the channels. The host must outlive this.
  RecordedWords(const ControllerHost& host, const mcap::Reader& trace);

  const std::vector<std::uint16_t>& channels() const { return channels_; }
  /// Takes a message of one of channels(). An error names topic and time if its bytes don't fit.
  Result<void> accept(const mcap::Message& message);
  /// What happened now.
  void say(const std::vector<msg::Event>& events);

  using OnDifference = std::function<void(Divergence&&)>;
  /// The messages since the last call are those of a tick that is about to be controlled. Lines that are said between
  /// two ticks are the earlier one's: calls `differs` with the first line of that one that isn't the same now.
  void begin_tick(const OnDifference& differs);
  /// The same of the last tick.
  void end(const OnDifference& differs);
  /// Calls `differs` for each variable of this tick that isn't the same bits now. Tick and time are the caller's to
  /// fill in. Returns how many were compared.
  std::int64_t compare_variables(const OnDifference& differs) const;
  /// Lines compared so far.
  std::int64_t lines() const { return lines_; }
  /// True if all events of the host and its controllers so far, with tick and severity, are the recorded ones.
  bool same_events() const { return recorded_events_.value() == said_events_.value(); }

 private:
  struct Variable {
    std::string topic;
    std::optional<double> value;      // in the messages since begin_tick()
    std::optional<double> this_tick;  // in the tick that is controlled
  };
  using Lines = std::vector<std::string>;  // "SR1/Walker: text"
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
