// Inertias about the axes of a body's joints. Private to the world library.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
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

  /// A spatial inertia about reference_: [inertia, [moment]x; -[moment]x, mass].
  struct Subtree {
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();  // mass times the centre's distance
    double mass = 0.0;
    Vector6d momentum(const Eigen::Vector3d& w, const Eigen::Vector3d& v) const;
  };
  /// Of a tree that isn't fixed to the world: its factors.
  using Whole = Eigen::LDLT<Eigen::Matrix<double, 6, 6>>;

  static Whole factored(const Subtree& tree);
  double of_motion(int part, const Eigen::Vector3d& w, const Eigen::Vector3d& v) const;

  Eigen::Vector3d reference_;      // of motions: rotation w, then velocity v of this point
  std::vector<Subtree> subtrees_;  // by part: it and all parts beyond it
  std::vector<int> wholes_of_;     // by part: the index of its tree's factors; -1: the tree is fixed to the world
  std::vector<Whole> wholes_;
};

}  // namespace rehearse
