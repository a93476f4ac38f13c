// A scenario for a robot that has none yet: it stands on a floor, with the controllers that are named.
#pragma once

#include <rehearse/model.h>
#include <rehearse/scenario.h>

#include <optional>
#include <string>
#include <vector>

namespace rehearse::tool {

/// Each joint at 0 [rad] or [m], or where it can be nearest to it, by joint id.
std::vector<double> rest_posture(const Model& model);

struct ModelScenario {
  std::string model;                     // a URDF
  std::vector<std::string> controllers;  // libraries: names or paths
  std::optional<double> duration;        // [s]; 2 if not stated
};

/// The scenario as YAML: the robot at rest, its lowest point on the floor, unless the model itself is fixed to the world.
/// `model_file`: how the scenario names the model. Fails with the model's own errors.
Result<std::string> scenario_text(const ModelScenario& settings, const std::string& model_file);

/// The scenario of that text, with the model as named in `settings`.
Result<Scenario> scenario_of_model(const ModelScenario& settings);

/// Writes the scenario to a new file, which names the model and libraries relative to its folder. Fails if there is such
/// a file.
Result<void> save_scenario(const ModelScenario& settings, const std::string& file);

}  // namespace rehearse::tool
