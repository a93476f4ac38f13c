// PerturbedRun: repeats a recording on some levels, in a separate process with different arithmetic. The measurement of
// noise (noise_floor.h) starts these processes with the command `golden noise --perturbed`.
#pragma once

#include <rehearse/check.h>
#include <rehearse/run_options.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/guard/child_process.h"

namespace rehearse {

struct PerturbedRun {
  std::filesystem::path scenario;
  std::filesystem::path recording;
  std::filesystem::path folder;  // for the results: plant.mcap, closed.mcap, report.json
  double duration = 0.0;         // [s]
  bool controller = false, plant = false, closed = false;
  HostOptions host;
};

/// Makes the runs, each in a process that has run no controller if this one has own processes. Fails if the scenario
/// can't be loaded or a run can't be made.
Result<void> make_perturbed_run(const PerturbedRun& run, const Simulation& simulation);

/// The results of such a process.
struct PerturbedOutcome {
  bool same_mathematics = false;  // its C library computes the same bits as this process's
  std::map<std::pair<std::string, std::string>, double> commands;  // largest difference by topic and unit
  std::optional<Divergence> beyond;                                // the first command beyond tolerance
};

/// Starts `program golden noise --perturbed ...` with a changed environment and REHEARSE_PIN=off, and waits for it. Its
/// traces stay in the run's folder.
Result<PerturbedOutcome> run_perturbed_process(const std::filesystem::path& program, const PerturbedRun& run,
                                               const EnvironmentChanges& changes);

}  // namespace rehearse
