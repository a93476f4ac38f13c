// RecordedCheckpoints: the states of the world that a recording has.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>
#include <rehearse/world.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "trace/channel_name.h"
#include "trace/trace_windows.h"

namespace rehearse {

class RecordedCheckpoints {
 public:
  /// The states are for worlds of `scenario`, which need not be the recording's own. Both must outlive this.
  RecordedCheckpoints(const Trace& recording, const Scenario& scenario);

  /// Why none of them can be used: a sentence; empty: they can.
  Result<std::string> objection() const;
  /// Sets the world to the state at the beginning of that tick. False: there is no checkpoint there. If the recording's
  /// bodies or models aren't those of the scenario, parts are matched by their names. Fails, naming them, if the state
  /// lacks parts of the world.
  Result<bool> restore(std::int64_t tick, World& world);
  /// The ticks that have one, ascending.
  std::vector<std::int64_t> ticks() const;

 private:
  Result<msg::Checkpoint> read(std::size_t row) const;
  bool has_its_own_scenario() const;
  Result<void> make_recorded_world();

  const Trace& recording_;
  const Scenario& scenario_;
  std::unique_ptr<TraceWindows> messages_;  // of the checkpoints; null: the recording holds its messages
  const TraceChannel* channel_;
  std::unique_ptr<World> recorded_world_;  // that the states are of, without shapes; null: they are of the scenario's
  bool prepared_ = false;
};

}  // namespace rehearse
