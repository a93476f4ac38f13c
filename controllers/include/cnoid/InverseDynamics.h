// Inverse dynamics: the efforts of the joints for given displacements, velocities and accelerations.
#pragma once

#include "Config.h"
#include "EigenTypes.h"

namespace cnoid {

class Link;

/// For the link and all links below it: see LinkTraverse::calcInverseDynamics(). The link is usually the root. If it
/// has a parent, its v(), w(), dv(), dw() are computed from the parent's, and its own joint's u() is written, too. The
/// result is the wrench that acts on the link through its joint, or on a root link from outside: world axes, torque
/// about the world's origin [N, N·m].
CNOID_GENERAL_EXPORT Vector6 calcInverseDynamics(Link* link);

}  // namespace cnoid
