// The scenario of a replayed log: what a recording of it says was run.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <string>

#include "log_map/log_map.h"

namespace rehearse {

/// What a scenario of a log is made of.
struct LogScenarioParts {
  const LogMap& map;
  const Model& model;
  std::string model_file;  // its name, without folders
  std::string log;         // its name, without folders
  std::string library;     // of the controller, as it was given
  std::int64_t ticks = 0;
  const BodyObservation& seen;  // at the first tick; NaN for joints that nothing gives
};

/// A scenario's text: one body, where and as the log has it at the first tick, under one controller.
std::string log_scenario_text(const LogScenarioParts& parts);

}  // namespace rehearse
