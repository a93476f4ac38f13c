// Leading a world to a moment of a recording.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>

#include "core/recording/recorder.h"
#include "plant.h"
#include "recorded_checkpoints.h"
#include "world_source.h"

namespace rehearse {

struct LedWorld {
  Command command;                // in force at the moment, with the recorded drives
  std::uint64_t hash_before = 0;  // of the world's state, one tick before the moment
};

/// The checkpoints of a recording that matter for a moment: from at most a second before the one that
/// latest_checkpoint() finds, to the moment; all, if there is only one of these.
RecordedCheckpoints checkpoints_before(const Trace& recording, const Scenario& scenario, std::int64_t moment);

/// The tick of the latest checkpoint from which lead_world() can move a world to the moment; 0: from the start.
std::int64_t latest_checkpoint(const RecordedCheckpoints& checkpoints, const Scenario& scenario, std::int64_t moment);

/// Moves a new world to its state at the beginning of the tick `moment`, with all pending captures. It starts from the
/// recorded checkpoint at tick `from` (0: from the start) and moves by the recorded commands. The recorder gets
/// nothing but the contacts, which count as existing. Fails if the simulation explodes on the way or a signal ends it.
Result<LedWorld> lead_world(const Scenario& scenario, const Trace& recording, RecordedCheckpoints& checkpoints,
                            std::int64_t from, std::int64_t moment, Plant& plant, WorldSource& world,
                            Recorder& recorder);

}  // namespace rehearse
