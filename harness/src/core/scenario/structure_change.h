// The first change of a scenario's structure: its bodies, their controllers and how these take part, and the joints,
// links and devices of their models.
#pragma once

#include <rehearse/scenario.h>

#include <string>

namespace rehearse {

/// Compares the text of a scenario with an earlier one. "line 12: delay of controller 'Arm/Hold' is false, and was
/// true"; bodies and controllers that are new, renamed or gone are found likewise. The order of bodies doesn't count.
/// Empty: the structure is the same, or one of the texts is no YAML.
std::string structure_change(const std::string& before, const std::string& now);

/// Compares the models of the bodies that both scenarios contain: "the model of 'Arm' changed: joint 'ELBOW' was
/// named 'SHOULDER'". Empty: their joints, links and devices have the same names.
std::string model_change(const Scenario& before, const Scenario& now);

}  // namespace rehearse
