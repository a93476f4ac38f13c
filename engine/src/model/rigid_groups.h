// RigidGroups: the links of a model that fixed joints and tracks hold together, which physics takes for one rigid body.
// Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <vector>

namespace rehearse {

/// Where a link sits in its group, whose frame is that of its first link.
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

/// An inertial given in a frame that has this pose, in the frame in which the pose is given.
Inertial moved(const Inertial& inertial, const Eigen::Isometry3d& pose);

/// Principal moments, ascending [kg·m²].
Eigen::Vector3d principal_moments(const Eigen::Matrix3d& inertia);

/// Whether a body with that inertia can be turned, beyond doubt by rounding.
bool is_positive_definite(const Eigen::Matrix3d& inertia);

}  // namespace rehearse
