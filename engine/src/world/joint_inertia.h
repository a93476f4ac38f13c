// Inertias about the axes of a body's joints. Private to the world library.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <vector>

namespace rehearse {

/// A rigid body of one or more trees. Vectors and matrices are in world axes.
struct RigidPart {
  int parent = -1;    // index of the part to which its joint connects it; less than its own index; -1: none
  double mass = 0.0;  // [kg]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();   // of mass [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre [kg·m²]
  bool moves = true;                                  // false: it is fixed to the world
};

/// The inertias that efforts at single joints accelerate while all other joints are locked.
class JointInertias {
 public:
  explicit JointInertias(const std::vector<RigidPart>& parts);

  /// Of the joint between a part and its parent, whose axis is a unit vector through `anchor`: [kg·m²], or [kg] for a
  /// joint that slides along the axis.
  double about(int part, const Eigen::Vector3d& axis, const Eigen::Vector3d& anchor) const;
  double along(int part, const Eigen::Vector3d& axis) const;

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  double of_motion(int part, const Vector6d& motion) const;

  Eigen::Vector3d reference_;                            // of motions: rotation, then velocity of this point
  std::vector<Matrix6d> subtrees_;                       // by part: spatial inertia of it and all parts beyond it
  std::vector<std::size_t> roots_;                       // by part: the first part of its tree
  std::map<std::size_t, Eigen::LDLT<Matrix6d>> wholes_;  // by root, of trees that aren't fixed to the world
};

}  // namespace rehearse
