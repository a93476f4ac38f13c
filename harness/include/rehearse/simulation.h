// Simulation: the options and results of runs with physics, and the functions that make such runs.
//
// session.h declares the functions themselves. They need ODE, and OSMesa for cameras. A library that neither simulates
// nor draws (a check, a partial acceptance) is given a Simulation by its caller.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/host_options.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace rehearse {

struct RecordOptions : HostOptions {
  /// Simulated time from one checkpoint to the next [s]; at least a tick; 0: there are none, and the plant level of a
  /// check runs from the start.
  double checkpoint_period = 0.1;
  /// Moves each body by a last bit before the first tick, to see how far that carries. See World::nudge().
  std::optional<std::uint32_t> nudge;
  /// Called about every hundredth of the run with the ticks done and all; null: not.
  std::function<void(std::int64_t done, std::int64_t all)> progress;
};

/// What a run came to.
struct RunSummary {
  std::int64_t ticks = 0;
  int channels = 0;
  std::int64_t frames = 0;            // colour pictures
  std::uintmax_t bytes = 0;           // of the trace file
  std::optional<Diagnostic> failure;  // a controller threw, crashed or hung, or the simulation exploded: it ended there
  bool controller_refused = false;    // a controller returned false from configure, initialize or start
  Diagnostics remarks;  // what controllers did that they should not have, and World::remarks(); warnings and errors
};

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

/// Moves a scenario's world by the commands of a recording (session.h: run_plant).
using RunPlant = std::function<Result<PlantSummary>(const Scenario&, const Trace& recording,
                                                    const std::filesystem::path& trace, const PlantOptions&)>;

/// The functions of session.h, for libraries that don't link them.
struct Simulation {
  std::function<Result<RunSummary>(const Scenario&, const std::filesystem::path& trace, const RecordOptions&)> record;
  RunPlant run_plant;
};

}  // namespace rehearse
