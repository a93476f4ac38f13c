// A scenario for a robot without one: the robot on a floor, with the named controllers.
#pragma once

#include <rehearse/model.h>
#include <rehearse/scenario.h>
#include <rehearse/urdf.h>

#include <optional>
#include <string>
#include <vector>

#include "logs/robot_log/log_replay.h"

namespace rehearse::tool {

/// Displacement of each joint, by joint id: 0 [rad] or [m], or the nearest value within its limits.
std::vector<double> rest_posture(const Model& model);

/// The begin of a run in a robot's log.
struct RunOfALog {
  std::string log;   // its file
  std::string body;  // the robot's name
  LogStart begin;
  double time_step = 0.001;  // [s]
  MappedController controller;
};

struct ModelScenario {
  std::string model;                     // a URDF
  std::vector<std::string> controllers;  // libraries: names or paths
  std::optional<double> duration;        // [s]; default 2
  std::optional<RunOfALog> run;          // none: the robot is at rest
  UrdfOptions urdf = {};                 // packages, masses and meshes that are missing
  std::string solver = {};               // quick, exact or direct; empty: the scenario doesn't state it
};

/// The scenario as YAML: the robot at rest, or in the posture of a log, its lowest point on the floor, unless the model
/// itself is fixed to the world; with the log's joystick. `model_file`: the model's name in the scenario. Fails with
/// the model's own errors.
Result<std::string> scenario_text(const ModelScenario& settings, const std::string& model_file);

/// Parses that text as a scenario, with the model as named in `settings`.
Result<Scenario> scenario_of_model(const ModelScenario& settings);

/// Fails if the file exists.
Result<void> check_unused(const std::string& file);

/// Writes the scenario to a new file, which names the model and libraries relative to its folder. Fails if the file
/// exists.
Result<void> save_scenario(const ModelScenario& settings, const std::string& file);

}  // namespace rehearse::tool
