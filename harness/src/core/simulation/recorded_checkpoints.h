// RecordedCheckpoints: the states of the world in a recording.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>
#include <rehearse/world.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/kinds/channel_name.h"
#include "core/trace/trace_windows.h"

namespace rehearse {

class RecordedCheckpoints {
 public:
  static constexpr std::int64_t no_end = std::numeric_limits<std::int64_t>::max();

  /// The states are for worlds of `scenario`, which may differ from the recording's scenario. Both must outlive this.
  /// Of a recording whose messages stay in its file, those of the ticks `from` to `to` are read.
  RecordedCheckpoints(const Trace& recording, const Scenario& scenario, std::int64_t from = 0,
                      std::int64_t to = no_end);

  /// A sentence: why none of them can be used; empty: they can be used.
  Result<std::string> objection() const;
  /// Sets the world to the state at the beginning of that tick. False: there is no checkpoint there. If the recording's
  /// bodies or models differ from those of the scenario, parts are matched by their names. Fails with the names of
  /// parts of the world that the state lacks. `readings`: gets the part of the state that is of Plant::save_readings(),
  /// nothing if the recording's scenario isn't this one.
  Result<bool> restore(std::int64_t tick, World& world, std::vector<std::byte>* readings = nullptr);
  /// The ticks with a checkpoint, ascending.
  std::vector<std::int64_t> ticks() const;

 private:
  Result<msg::Checkpoint> read(std::size_t row) const;
  bool has_its_own_scenario() const;
  Result<void> make_recorded_world();

  const Trace& recording_;
  const Scenario& scenario_;
  std::unique_ptr<TraceWindows> messages_;  // of the checkpoints; null: the recording's messages are in memory
  const TraceChannel* channel_;
  /// The world of these states, without shapes; null: it is the scenario's world.
  std::unique_ptr<World> recorded_world_;
  bool prepared_ = false;
  std::size_t readings_size_ = 0;  // of the readings behind the world's state [bytes]
};

}  // namespace rehearse
