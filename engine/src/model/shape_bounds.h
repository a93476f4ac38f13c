// Boxes around shapes. Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>

namespace rehearse {

/// The smallest box around a shape, along the axes of the frame in which `pose` is given [m]. For a mesh it is the box
/// around the mesh's bounding box. Empty if the model was loaded without the mesh.
Eigen::AlignedBox3d bounds(const Geometry& geometry, const Eigen::Isometry3d& pose);

}  // namespace rehearse
