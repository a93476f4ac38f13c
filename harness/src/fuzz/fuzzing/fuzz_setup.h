// FuzzSetup: a plan, checked against its model: the scenario of its runs, and the columns of their inputs. Internal.
#pragma once

#include <rehearse/fuzz.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <string>
#include <vector>

#include "inputs.h"

namespace rehearse {

struct FuzzSetup {
  FuzzPlan plan;
  Scenario scenario;  // one body, one controller, the expectations; no physics runs it
  std::vector<InputColumn> columns;
  std::vector<std::size_t> values_of_devices;  // by device index: how many it measures; 0: the runs leave it alone
  std::vector<std::size_t> first_of_devices;   // by device index: the column of its first value

  const std::string& body() const { return scenario.bodies[0].name; }
  const Model& model() const { return *scenario.bodies[0].model; }
};

/// Fails with what is wrong with the plan.
Result<FuzzSetup> set_up(const FuzzPlan& plan);

/// The text of a scenario with so many ticks of the plan's runs; recordings contain it. `body`: the name of the model.
std::string scenario_text(const FuzzPlan& plan, const std::string& body, int ticks);
/// The scenario of this text.
Result<Scenario> scenario_of(const FuzzPlan& plan, const std::string& body, int ticks);

}  // namespace rehearse
