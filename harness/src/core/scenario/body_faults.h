// Faults of a body that no file of a scenario states.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <string>
#include <vector>

namespace rehearse {

/// Adds faults to the body, after those that it has. `entries`: as in the `faults:` of a scenario. body.model must not
/// be null.
Result<void> add_faults(ScenarioBody& body, const std::vector<std::string>& entries);

}  // namespace rehearse
