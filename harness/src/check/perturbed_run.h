// PerturbedRun: a recording run again on all levels by a process whose arithmetic is another one. The measurement of
// noise (noise_floor.h) starts such processes; the command gives them their work.
#pragma once

#include <rehearse/check.h>
#include <rehearse/run_options.h>

#include <filesystem>

namespace rehearse {

struct PerturbedRun {
  std::filesystem::path scenario;
  std::filesystem::path recording;
  std::filesystem::path folder;  // for what comes of it: plant.mcap, closed.mcap, report.json
  double duration = 0.0;         // [s]
  bool controller = false, plant = false, closed = false;
  HostOptions host;
};

/// Does the work, in this process. Fails if the scenario can't be loaded or a run can't be made.
Result<void> make_perturbed_run(const PerturbedRun& run, const Simulation& simulation);

}  // namespace rehearse
