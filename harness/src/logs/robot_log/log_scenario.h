// The scenario of a replayed log, which its recording contains.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "logs/map/log_map.h"

namespace rehearse {

/// The parts of a log's scenario.
struct LogScenarioParts {
  const LogMap& map;
  const Model& model;
  std::string model_file;  // its name, without folders
  std::string log;         // its name, without folders
  std::string library;     // of the controller, as the user named it
  std::int64_t ticks = 0;
  const BodyObservation& seen;  // at the first tick; NaN for joints without a source
  /// Of the controllers' commands, after those of the map.
  std::vector<ToleranceRule> tolerances = {};
};

/// The text of the scenario: one body in the posture of the first tick in the log, with one controller.
std::string log_scenario_text(const LogScenarioParts& parts);

}  // namespace rehearse
