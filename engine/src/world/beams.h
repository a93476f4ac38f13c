// Intersections of a range sensor's beams with collision shapes, in ODE. Private to the world library.
#pragma once

#include <rehearse/model.h>

#include <memory>
#include <vector>

#include "simulated_body.h"

namespace rehearse {

/// The distance of the nearest collision shape along each beam [m], rounded to float; +inf if there is none up to the
/// sensor's maximum. `pose`: of the sensor's device frame in the world. The sensor, on link `link` of body `owner`,
/// doesn't see shapes of its own rigid group. A beam begins at the sensor's minimum distance and passes through shapes
/// that contain its beginning, because only the outside of a shape is seen.
std::vector<float> measure_beams(const RangeSensor& sensor, const Eigen::Isometry3d& pose,
                                 const std::vector<std::unique_ptr<SimulatedBody>>& bodies, int owner, int link);

}  // namespace rehearse
