// Leading a world to a moment of a recording.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>

#include "plant.h"
#include "recording/recorder.h"
#include "world_source.h"

namespace rehearse {

/// The number of ticks that cameras and range sensors must run before a moment. Then all captures that arrive at the
/// moment or later are captured again. It is twice the longest cycle, which is a second at most (renderer/vision.h).
std::int64_t lead_of(const Scenario& scenario);

struct LedWorld {
  Command command;                // in force at the moment, with the recorded drives
  std::uint64_t hash_before = 0;  // of the world's state, one tick before the moment
};

/// Moves a new world to its state at the beginning of the tick `moment`, with all pending captures. It starts from the
/// recorded checkpoint at tick `checkpoint` (0: from the start) and moves by the recorded commands. The recorder gets
/// nothing but the contacts, which count as existing. Fails if the simulation explodes on the way or a signal ends it.
Result<LedWorld> lead_world(const Scenario& scenario, const Trace& recording, std::int64_t checkpoint,
                            std::int64_t moment, Plant& plant, WorldSource& world, Recorder& recorder);

/// Replaces the drives of a command by the drives of another command.
void take_drives(const Command& drives, Command& command);

}  // namespace rehearse
