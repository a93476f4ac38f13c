// The rotation of a rigid body without torques in a step of ODE. Private to the world library.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace rehearse {

/// The angular velocity after a step, in the axes that the body has before the step [rad/s]. ODE turns a body by the
/// angle 2 atan(|w| dt / 2) about its new angular velocity w. The angular velocities are taken as those in the middle
/// of the turns, so that the angular momentum stays the same and the energy swings within bounds:
///     H(w') I w' = H(w)^-1 I w, where H(w) turns by half of ODE's angle.
/// `inertia`: about the centre, along the body's axes [kg·m²], and its inverse; `angular_velocity`: in the same axes
/// [rad/s]. Nullopt if the body turns too fast for the step: the equation has no solution nearby.
std::optional<Eigen::Vector3d> rotate_freely(const Eigen::Matrix3d& inertia, const Eigen::Matrix3d& inverse,
                                             const Eigen::Vector3d& angular_velocity, double time_step);

}  // namespace rehearse
