#include "joint_inertia.h"

#include <Eigen/Geometry>

namespace rehearse {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return matrix;
}

}  // namespace

// Spatial inertias: R. Featherstone, Rigid Body Dynamics Algorithms, 2.13.
JointInertias::JointInertias(const std::vector<RigidPart>& parts)
    : reference_(parts.front().center), subtrees_(parts.size()) {
  for (std::size_t i = parts.size(); i-- > 0;) {
    const RigidPart& part = parts[i];
    Subtree& subtree = subtrees_[i];
    const Vector3d arm = part.center - reference_;
    const Vector3d moment = part.mass * arm;
    // the inertia about the centre - [moment]x [arm]x
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) {
        const double parallel = r == c ? moment[(r + 1) % 3] * arm[(r + 1) % 3] + moment[(r + 2) % 3] * arm[(r + 2) % 3]
                                       : -arm[r] * moment[c];
        subtree.inertia(r, c) += part.inertia(r, c) + parallel;
      }
    subtree.moment += moment;
    subtree.mass += part.mass;
    if (part.parent < 0) continue;
    subtrees_[part.parent].inertia += subtree.inertia;
    subtrees_[part.parent].moment += subtree.moment;
    subtrees_[part.parent].mass += subtree.mass;
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool is_free = parts[i].parent < 0 && parts[i].moves;
    wholes_of_.push_back(parts[i].parent >= 0 ? wholes_of_[parts[i].parent]
                         : is_free            ? static_cast<int>(wholes_.size())
                                              : -1);
    if (is_free) wholes_.push_back(factored(subtrees_[i]));
  }
}

JointInertias::Whole JointInertias::factored(const Subtree& tree) {
  const Matrix3d cross = cross_matrix(tree.moment);
  Eigen::Matrix<double, 6, 6> spatial;
  spatial.topLeftCorner<3, 3>() = tree.inertia;
  spatial.topRightCorner<3, 3>() = cross;
  spatial.bottomLeftCorner<3, 3>() = -cross;
  spatial.bottomRightCorner<3, 3>() = tree.mass * Matrix3d::Identity();
  return Whole(spatial);
}

/// About the reference, then the linear one. Each sum has the order of a line of the 6x6 matrix.
Vector6d JointInertias::Subtree::momentum(const Vector3d& w, const Vector3d& v) const {
  const Vector3d& c = moment;
  const auto angular = [&](int i) { return inertia(i, 0) * w[0] + inertia(i, 1) * w[1] + inertia(i, 2) * w[2]; };
  Vector6d sum;
  sum[0] = angular(0) - c.z() * v.y() + c.y() * v.z();
  sum[1] = angular(1) + c.z() * v.x() - c.x() * v.z();
  sum[2] = angular(2) - c.y() * v.x() + c.x() * v.y();
  sum[3] = c.z() * w.y() - c.y() * w.z() + mass * v.x();
  sum[4] = c.x() * w.z() - c.z() * w.x() + mass * v.y();
  sum[5] = c.y() * w.x() - c.x() * w.y() + mass * v.z();
  return sum;
}

/// With A beyond the joint and B before it, the inertia is s' A s, or, if B moves, s' A (A + B)^-1 B s.
double JointInertias::of_motion(int part, const Vector3d& w, const Vector3d& v) const {
  const Vector6d momentum = subtrees_[part].momentum(w, v);
  Vector6d motion;
  motion.head<3>() = w;
  motion.tail<3>() = v;
  const double inertia = motion.dot(momentum);
  if (wholes_of_[part] < 0) return inertia;
  return inertia - momentum.dot(wholes_[wholes_of_[part]].solve(momentum));
}

double JointInertias::about(int part, const Vector3d& axis, const Vector3d& anchor) const {
  return of_motion(part, axis, axis.cross(reference_ - anchor));
}

double JointInertias::along(int part, const Vector3d& axis) const { return of_motion(part, Vector3d::Zero(), axis); }

}  // namespace rehearse
