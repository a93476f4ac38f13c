// The parts of `rehearse sweep`.
#pragma once

#include <rehearse/shrink.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "campaigns/slurm/slurm.h"
#include "command.h"

namespace rehearse::tool {

struct SweepSettings {
  std::string scenario, folder;
  CampaignOptions campaign;
  SweepOptions sweep;
  std::string slice;  // "i/n"; empty: none
  bool golden = false, json = false;
  bool plan = false;      // no case is run
  bool in_slurm = false;  // cases are run by Slurm's tasks
  SlurmOptions slurm;
  std::int64_t jobs = 0;         // 0: one for each processor
  std::string against;           // another campaign; empty: none
  std::optional<double> margin;  // of --against: by which the share that passes may be smaller
  std::int64_t number = 0;
  std::string output;                            // of case and shrink; empty: in the campaign's folder
  std::optional<std::vector<KeptFailure>> kept;  // of the project, run before the cases; none: not run
  ShrinkOptions shrink;
  SearchOptions search;  // its expectation is empty: no search
};

Simulation simulation();

/// sweep case
Exit run_case_again(SweepSettings& settings);
/// sweep shrink
Exit run_shrink(SweepSettings& settings);
/// sweep --towards
Exit run_search(SweepSettings& settings);

}  // namespace rehearse::tool
