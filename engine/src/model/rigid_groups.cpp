#include "rigid_groups.h"

#include <Eigen/Eigenvalues>

namespace rehearse {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Parallel axis theorem.
Inertial sum(const Inertial& a, const Inertial& b) {
  if (a.mass == 0.0) return b;
  if (b.mass == 0.0) return a;
  Inertial total;
  total.mass = a.mass + b.mass;
  total.center = (a.mass * a.center + b.mass * b.center) / total.mass;
  for (const Inertial* part : {&a, &b}) {
    const Vector3d d = part->center - total.center;
    total.inertia += part->inertia + part->mass * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose());
  }
  return total;
}

Inertial moved(const Inertial& inertial, const Eigen::Isometry3d& pose) {
  const Matrix3d& turn = pose.linear();
  return {inertial.mass, pose * inertial.center, turn * inertial.inertia * turn.transpose()};
}

RigidGroups group_links(const Model& model) {
  RigidGroups groups;
  for (const Link& link : model.links) {
    GroupedLink grouped;
    grouped.leads_group = link.parent < 0 || is_movable(link.joint.type) || link.joint.type == JointType::free;
    if (grouped.leads_group) {
      grouped.group = static_cast<int>(groups.first_links.size());
      groups.first_links.push_back(static_cast<int>(groups.links.size()));
      groups.inertials.push_back(link.inertial);
    } else {
      const GroupedLink& parent = groups.links[static_cast<std::size_t>(link.parent)];
      grouped.group = parent.group;
      grouped.in_group = parent.in_group * link.joint.origin;
      grouped.rotation_in_group = Eigen::Quaterniond(grouped.in_group.linear()).normalized();
      Inertial& whole = groups.inertials[static_cast<std::size_t>(grouped.group)];
      whole = sum(whole, moved(link.inertial, grouped.in_group));
    }
    groups.links.push_back(grouped);
  }
  return groups;
}

Vector3d principal_moments(const Matrix3d& inertia) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

bool is_positive_definite(const Matrix3d& inertia) {
  constexpr double rounding = 1e-12;
  if (!inertia.allFinite()) return false;
  const Vector3d moments = principal_moments(inertia);
  return moments.x() > rounding * moments.z();
}

}  // namespace rehearse
