// PlantRun: the commands of a recording into the world, without its controllers. What the plant level of a check stands
// on.
//
// At each checkpoint of the recording the world is set back to the recorded state, so that a difference never grows for
// longer than from one checkpoint to the next: what is left is what the simulation does otherwise, not what became of it.
// The state at a checkpoint itself is recorded before it is restored. Needs the simulation, like session.h.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace rehearse {

struct PlantOptions {
  /// Where to begin; there must be a checkpoint, or it is 0. Cameras and range sensors say nothing of what they had
  /// captured before.
  std::int64_t from = 0;              // tick
  std::optional<std::int64_t> until;  // the state at this tick is the last that is recorded; none: the recording's last
  /// Set back at each checkpoint; else at the one it begins at only.
  bool resync = true;
  /// The noise of sensors is that of this scenario; null: of the scenario that runs.
  const Scenario* noise_of = nullptr;
  /// Moves each body by a last bit wherever the state is set back, and at the beginning: what that does to a run is
  /// noise, and no fault. See World::nudge().
  std::optional<std::uint32_t> nudge;
  /// Called about every hundredth of the run with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

struct PlantSummary {
  std::int64_t ticks = 0;
  std::int64_t restored = 0;          // checkpoints that the world was set back to
  std::string from_the_start;         // why none was: a sentence; empty: they were, or nobody wanted it
  std::optional<Diagnostic> failure;  // the simulation exploded; it ended there
};

/// Runs the scenario's world under the recorded commands and writes what it did into a trace: state, sensors, frames and
/// the hash of the state. If the recording has no checkpoints, or says that they aren't exact, or they are of a kind
/// that this version can't restore, it runs from the start without them and says so. Fails if the recording commands
/// something that the scenario hasn't, if the scenario has another time step or parts that the checkpoints have no state
/// of, or if the run can't begin.
Result<PlantSummary> run_plant(const Scenario& scenario, const Trace& recording, const std::filesystem::path& trace,
                               const PlantOptions& options = {});

}  // namespace rehearse
