// A perturbed run in a process of its own, and its results. Internal to the measurement of noise.
#pragma once

#include <rehearse/compare.h>

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "host/child_process.h"
#include "perturbed_run.h"

namespace rehearse {

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
