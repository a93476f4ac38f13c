// Intersection of a beam with a heightmap. Private to the world library.
#pragma once

#include <rehearse/model.h>

namespace rehearse {

/// Distance from `from` along the unit vector `direction`, both in the heightmap's frame, to the first point of the
/// surface, seen from above or below [m]; +inf if there is none up to `length`.
double beam_to_ground(const Heightmap& map, const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                      double length);

}  // namespace rehearse
