// The commands of controllers that a robot can execute.
#pragma once

#include <rehearse/scenario.h>

#include <string>
#include <vector>

namespace rehearse {

/// A sentence for each part of the actuation mode (cnoid::Link's state flags) that drives nothing on that link.
std::vector<std::string> useless_outputs(const ScenarioBody& body, int link, int mode);

/// "JointEffort", or "JointDisplacement and JointEffort"; "no mode" if no part of it drives a joint.
std::string joint_mode_names(int mode);

}  // namespace rehearse
