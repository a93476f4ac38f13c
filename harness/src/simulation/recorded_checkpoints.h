// RecordedCheckpoints: the states of the world that a recording has.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

class RecordedCheckpoints {
 public:
  /// The recording must outlive this.
  RecordedCheckpoints(const Trace& recording, const Scenario& scenario)
      : recording_(recording), channel_(recording.find_channel("/checkpoint")), time_step_(scenario.time_step) {}

  /// Why none of them can be used: a sentence; empty: they can.
  Result<std::string> objection() const;
  /// The state at the beginning of that tick; none: there is no checkpoint there.
  Result<std::optional<std::vector<std::byte>>> at(std::int64_t tick) const;
  /// The ticks that have one, ascending.
  std::vector<std::int64_t> ticks() const;

 private:
  Result<msg::Checkpoint> read(std::size_t row) const;

  const Trace& recording_;
  const TraceChannel* channel_;
  double time_step_;  // [s]
};

}  // namespace rehearse
