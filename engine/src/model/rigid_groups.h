// RigidGroups: the links of a model that fixed joints and tracks connect; the physics simulates each group as one body.
// Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <vector>

namespace rehearse {

/// The pose of a link in its group. The group's frame is the frame of its first link.
struct GroupedLink {
  int group = 0;
  Eigen::Isometry3d in_group = Eigen::Isometry3d::Identity();
  Eigen::Quaterniond rotation_in_group = Eigen::Quaterniond::Identity();
  bool leads_group = true;  // in_group is the identity
};

struct RigidGroups {
  std::vector<GroupedLink> links;   // by link index
  std::vector<int> first_links;     // by group
  std::vector<Inertial> inertials;  // by group, in its frame
};

RigidGroups group_links(const Model& model);

/// The sum of two inertials given in one frame.
Inertial sum(const Inertial& a, const Inertial& b);

/// Transforms an inertial from a frame with this pose into the frame in which the pose is given.
Inertial moved(const Inertial& inertial, const Eigen::Isometry3d& pose);

/// Principal moments, ascending [kg·m²].
Eigen::Vector3d principal_moments(const Eigen::Matrix3d& inertia);

/// True if the inertia matrix is positive definite by more than rounding errors.
bool is_positive_definite(const Eigen::Matrix3d& inertia);

}  // namespace rehearse
