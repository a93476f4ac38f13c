// The velocities with which the links of a body begin. Private to the world library.
#pragma once

#include <rehearse/world.h>

#include <Eigen/Geometry>
#include <vector>

namespace rehearse {

/// Velocities of a link, world axes.
struct LinkMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // of its origin [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // [rad/s]
};

/// By link index. `poses`: of the links, by forward kinematics. A link behind a free joint begins as if it were fixed
/// to its parent.
std::vector<LinkMotion> initial_motions(const WorldBody& body, const std::vector<Eigen::Isometry3d>& poses);

/// Errors about velocities that the body can't have. The messages begin with `name`, "body 'SR1': ".
Diagnostics check_velocities(const WorldBody& body, const std::string& name);

}  // namespace rehearse
