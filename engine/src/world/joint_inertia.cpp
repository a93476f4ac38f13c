#include "joint_inertia.h"

#include <Eigen/Geometry>

namespace rehearse {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

}  // namespace

// Spatial inertias: R. Featherstone, Rigid Body Dynamics Algorithms, 2.13.
JointInertias::JointInertias(const std::vector<RigidPart>& parts)
    : reference_(parts.front().center), subtrees_(parts.size(), Matrix6d::Zero()) {
  for (std::size_t i = parts.size(); i-- > 0;) {
    const RigidPart& part = parts[i];
    const Matrix3d arm = cross_matrix(part.center - reference_);
    Matrix6d spatial;
    spatial << part.inertia - part.mass * arm * arm, part.mass * arm, -part.mass * arm,
        part.mass * Matrix3d::Identity();
    subtrees_[i] += spatial;
    if (part.parent >= 0) subtrees_[part.parent] += subtrees_[i];
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    roots_.push_back(parts[i].parent < 0 ? i : roots_[parts[i].parent]);
    if (parts[i].parent < 0 && parts[i].moves) wholes_[i].compute(subtrees_[i]);
  }
}

/// With A beyond the joint and B before it, the inertia is s' A s, or, if B moves, s' A (A + B)^-1 B s.
double JointInertias::of_motion(int part, const Vector6d& motion) const {
  const Vector6d momentum = subtrees_[part] * motion;
  double inertia = motion.dot(momentum);
  if (const auto whole = wholes_.find(roots_[part]); whole != wholes_.end())
    inertia -= momentum.dot(whole->second.solve(momentum));
  return inertia;
}

double JointInertias::about(int part, const Vector3d& axis, const Vector3d& anchor) const {
  Vector6d motion;
  motion << axis, axis.cross(reference_ - anchor);
  return of_motion(part, motion);
}

double JointInertias::along(int part, const Vector3d& axis) const {
  Vector6d motion;
  motion << Vector3d::Zero(), axis;
  return of_motion(part, motion);
}

}  // namespace rehearse
