// Contact points of two shapes: by ODE, and with convex hulls by hull_contacts.h. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <vector>

#include "simulated_body.h"

namespace rehearse {

/// Writes the contact points in the form of dCollide, at most found.size(). Returns the number of points.
int collide_shapes(const BodyShape& a, const BodyShape& b, std::vector<dContactGeom>& found);

}  // namespace rehearse
