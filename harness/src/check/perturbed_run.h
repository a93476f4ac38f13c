// PerturbedRun: repeats a recording on some levels, in a process with different arithmetic. The measurement of noise
// (noise_floor.h) starts these processes with the command `golden noise --perturbed`.
#pragma once

#include <rehearse/check.h>
#include <rehearse/run_options.h>

#include <filesystem>

namespace rehearse {

struct PerturbedRun {
  std::filesystem::path scenario;
  std::filesystem::path recording;
  std::filesystem::path folder;  // for the results: plant.mcap, closed.mcap, report.json
  double duration = 0.0;         // [s]
  bool controller = false, plant = false, closed = false;
  HostOptions host;
};

/// Makes the runs in this process. Fails if the scenario can't be loaded or a run can't be made.
Result<void> make_perturbed_run(const PerturbedRun& run, const Simulation& simulation);

}  // namespace rehearse
