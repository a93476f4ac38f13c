// A cut: an imaginary separation at a fixed joint (or a track's), to compute the wrench of the links behind it on the
// links before it. ODE has no joint there that could report a force: both sides are one rigid body. Private to the
// world library.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <vector>

#include "model/rigid_groups.h"

namespace rehearse {

/// The part of a rigid group behind a cut: the links that are connected to the rest only by the joint of one of them.
struct PartBehind {
  std::vector<bool> holds;  // by link index; true if the link is in the part
  Inertial inertial;        // of all links of the part, in the group's frame
  Inertial weight;          // of the links on which gravity acts
};

/// The part behind the joint of `link`, which connects it to its parent in the same rigid group.
PartBehind part_behind(const Model& model, const RigidGroups& groups, int link);

/// The motion of a rigid group in a step, in world axes.
struct GroupMotion {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();         // of the group
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                // of mass, of the whole group [m]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          // of the centre [m/s²]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // [rad/s]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // [rad/s²]
};

/// The wrench that must act on the part in addition to gravity [m/s²], so that the part moves with its group. The
/// torque is about `origin` [m, world]. Computed by the equations of Newton and Euler for a rigid body: R.
/// Featherstone, Rigid Body Dynamics Algorithms, 2.
Wrench wrench_to_move(const PartBehind& part, const GroupMotion& motion, const Eigen::Vector3d& gravity,
                      const Eigen::Vector3d& origin);

}  // namespace rehearse
