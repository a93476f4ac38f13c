// What a range sensor's beams meet, in ODE. Private to the world library.
#pragma once

#include <rehearse/model.h>

#include <memory>
#include <vector>

#include "simulated_body.h"

namespace rehearse {

/// The distance of the nearest collision shape along each beam [m], rounded to float; +inf if there is none up to the
/// sensor's maximum. `pose`: of the sensor's device frame in the world. Shapes of the sensor's own rigid group, on link
/// `link` of body `owner`, aren't seen. Only outsides are: a shape that holds a beam's beginning, at the sensor's
/// minimum, is looked through.
std::vector<float> measure_beams(const RangeSensor& sensor, const Eigen::Isometry3d& pose,
                                 const std::vector<std::unique_ptr<SimulatedBody>>& bodies, int owner, int link);

}  // namespace rehearse
