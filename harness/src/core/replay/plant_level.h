// The plant level of a check: simulates the world with the golden's commands, and compares the result with the golden.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/run_options.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace rehearse {

struct PlantLevel {
  PlantSummary run;
  Trace trace;            // without messages
  Comparison comparison;  // comparison of stages_of_plant, up to PlantOptions::until
};

/// The stages of a run that need no controller.
inline const std::vector<Stage> stages_of_plant{Stage::physics, Stage::sensors, Stage::renderer};

/// Noise floor of each series, as in CompareOptions::noise_floors.
using NoiseOfSeries = std::map<std::string, double, std::less<>>;

/// Writes the run's trace to `file`, whose folder is made if it is missing.
Result<PlantLevel> compare_plant(const Simulation& simulation, const Scenario& scenario, const Trace& golden,
                                 const std::filesystem::path& file, const PlantOptions& options,
                                 const NoiseOfSeries& noise = {});

/// Makes the folder of a file that is to be written.
Result<void> make_folder_of(const std::filesystem::path& file);

}  // namespace rehearse
