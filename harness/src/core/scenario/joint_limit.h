// The limits of a scenario's joints, by name. Internal.
#pragma once

#include <rehearse/scenario.h>

#include <string_view>

#include "core/expression/expression.h"

namespace rehearse {

/// The limit "effort", "velocity", "upper" or "lower" of a joint of a body's model. The joint is given as BODY/JOINT or
/// an unambiguous ending of it. Fails if there is no such joint, or if it has no such limit.
Result<JointLimit> joint_limit(const Scenario& scenario, std::string_view joint, std::string_view limit);

/// BODY/JOINT of all joints that move, in the order of bodies.
std::vector<std::string> joint_names(const Scenario& scenario);
/// BODY/LINK of all links.
std::vector<std::string> link_names(const Scenario& scenario);

}  // namespace rehearse
