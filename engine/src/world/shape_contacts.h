// Where two shapes touch: by ODE, and with convex hulls by our own. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <vector>

#include "simulated_body.h"

namespace rehearse {

/// The points where they touch, as dCollide tells them, at most found.size(). Returns how many were filled in.
int collide_shapes(const BodyShape& a, const BodyShape& b, std::vector<dContactGeom>& found);

}  // namespace rehearse
