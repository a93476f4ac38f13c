// Links that inverse kinematics leaves behind: those beside the paths that it solves.
#pragma once

#include <cnoid/LinkPath>

#include <vector>

namespace cnoid {

/// Computes the poses of all links of the end link's body that are on none of the paths. All paths lead to that link.
void calcRemainingForwardKinematics(Link& end, const std::vector<const LinkPath*>& paths);

}  // namespace cnoid
