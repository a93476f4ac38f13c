// What a robot can do of what its controllers want to command.
#pragma once

#include <rehearse/scenario.h>

#include <string>
#include <vector>

namespace rehearse {

/// A sentence for each way in which the actuation mode (cnoid::Link's state flags) drives nothing on that link.
std::vector<std::string> useless_outputs(const ScenarioBody& body, int link, int mode);

/// "JointEffort", or "JointDisplacement and JointEffort"; "no mode" if none of them drives a joint.
std::string joint_mode_names(int mode);

}  // namespace rehearse
