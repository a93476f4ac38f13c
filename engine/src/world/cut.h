// A cut: a fixed joint (or a track's) taken apart in thought, to find what the links behind it do to those before it.
// ODE has no joint there whose force could be read: both sides are one rigid body. Private to the world library.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <vector>

#include "model/rigid_groups.h"

namespace rehearse {

/// The links of a rigid group that hang on it by the joint of one of them.
struct PartBehind {
  std::vector<bool> holds;  // by link index
  Inertial inertial;        // of all of them, in the group's frame
  Inertial weight;          // of those that gravity pulls at
};

/// `link` is held by its parent in a group of links that never move against each other.
PartBehind part_behind(const Model& model, const RigidGroups& groups, int link);

/// How a rigid group moves in a step. World axes.
struct GroupMotion {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();         // of the group
  Eigen::Vector3d center = Eigen::Vector3d::Zero();                // of mass, of the whole group [m]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();          // of the centre [m/s²]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      // [rad/s]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // [rad/s²]
};

/// What else than gravity [m/s²] has to act on the part, so that it moves with its group. The torque is about `origin`
/// [m, world]. The equations of Newton and Euler for a rigid body: R. Featherstone, Rigid Body Dynamics Algorithms, 2.
Wrench wrench_to_move(const PartBehind& part, const GroupMotion& motion, const Eigen::Vector3d& gravity,
                      const Eigen::Vector3d& origin);

}  // namespace rehearse
