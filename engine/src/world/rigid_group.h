// RigidGroup: links that fixed joints connect, as one body of ODE. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>

#include "joint_inertia.h"
#include "ode_math.h"

namespace rehearse {

/// Links that fixed joints connect, as one body of ODE. Its axes are those of its first link; ODE's origin is at the
/// centre of mass.
struct RigidGroup {
  dBodyID body = nullptr;  // null: fixed to the world
  BodyNumbers numbers;     // of the body
  int first_link = 0;
  int parent = -1;                                   // the group to which its joint connects it
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of mass, in the group's frame [m]
  RigidMass nominal, weight;                         // without faults, and in the step
  Eigen::Matrix3d inverse_inertia = Eigen::Matrix3d::Zero();
  Eigen::Isometry3d fixed_pose = Eigen::Isometry3d::Identity();  // of the group's frame, when it never moves
  double factor = 1.0;                                           // of the nominal mass that faults make
  double weightless_mass = 0.0;                                  // nominal, of links on which gravity doesn't act [kg]
  Eigen::Vector3d weightless_moment = Eigen::Vector3d::Zero();   // that mass times its place from `center` [kg·m]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();        // of the centre, over the last step [m/s²]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  // over the last step [rad/s²]
  Eigen::Vector3d previous_velocity = Eigen::Vector3d::Zero();     // before the last step; scratch, not state
  Eigen::Vector3d previous_angular_velocity = Eigen::Vector3d::Zero();
};

/// False for the root, and for a link that a free joint separates from its parent.
inline bool has_joint(const Model& model, int link) {
  return link != 0 && model.links[link].joint.type != JointType::free;
}

}  // namespace rehearse
