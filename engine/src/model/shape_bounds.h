// Boxes around shapes. Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>

namespace rehearse {

/// The smallest box around a shape, along the axes of the frame in which `pose` places it [m]; around a mesh, that of
/// its own box. Empty if the model was loaded without the mesh.
Eigen::AlignedBox3d bounds(const Geometry& geometry, const Eigen::Isometry3d& pose);

}  // namespace rehearse
