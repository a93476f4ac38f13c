// Random trees of rigid bodies, and dense solutions of their equations to compare with.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <random>
#include <vector>

#include "solver/forest.h"

namespace rehearse {

/// Numbers that are the same with every standard library.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : engine_(seed) {}
  double uniform(double from, double to) {
    return from + (to - from) * (static_cast<double>(engine_()) / 4294967295.0);
  }
  int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }
  Vector6d vector6() {
    Vector6d v;
    for (double& x : v) x = uniform(-1.0, 1.0);
    return v;
  }

 private:
  std::mt19937 engine_;
};

/// A body with a random mass of 0.05 to 20 kg, a positive definite inertia and a random momentum.
inline TreeBody random_body(Dice& dice, int parent) {
  TreeBody body;
  body.parent = parent;
  body.mass = dice.uniform(0.05, 20.0);
  Eigen::Matrix3d root;
  for (double& x : root.reshaped()) x = dice.uniform(-0.2, 0.2);
  body.inertia = body.mass * (root * root.transpose() + 0.01 * Eigen::Matrix3d::Identity());
  body.momentum = dice.vector6();
  return body;
}

inline Row random_row(Dice& dice, double softness = 1e-7) {
  return {dice.vector6(), dice.vector6(), dice.uniform(-1.0, 1.0), softness};
}

/// Trees of `count` bodies: a body is the root of a tree, free or on a joint with the world, or has an earlier parent.
inline void make_trees(Dice& dice, int count, Forest& forest) {
  forest.bodies().clear();
  int root = 0;
  for (int i = 0; i < count; ++i) {
    const bool begins = i == 0 || dice.below(6) == 0;
    if (begins) root = i;
    TreeBody body = random_body(dice, begins ? -1 : root + dice.below(i - root));
    const int rows = begins ? dice.below(2) * dice.below(7) : dice.below(8);
    const double softness = rows < 6 ? 1e-7 : 1e-2;  // more rows than motions have no exact solution
    for (int r = 0; r < rows; ++r) body.joint.add() = random_row(dice, softness);
    forest.bodies().push_back(body);
  }
}

/// The equations of trees as one dense matrix: velocities, then the impulses of all joint rows.
struct DenseEquations {
  Eigen::MatrixXd mass;      // of all bodies
  Eigen::MatrixXd jacobian;  // rows of joints
  Eigen::VectorXd momentum, target, softness;

  explicit DenseEquations(const Forest& forest) {
    const auto& bodies = forest.bodies();
    const auto count = static_cast<Eigen::Index>(bodies.size());
    Eigen::Index rows = 0;
    for (const TreeBody& body : bodies) rows += static_cast<Eigen::Index>(body.joint.size());
    mass = Eigen::MatrixXd::Zero(6 * count, 6 * count);
    jacobian = Eigen::MatrixXd::Zero(rows, 6 * count);
    momentum.resize(6 * count);
    target.resize(rows);
    softness.resize(rows);
    Eigen::Index at = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const TreeBody& body = bodies[static_cast<std::size_t>(i)];
      mass.block<3, 3>(6 * i, 6 * i) = body.mass * Eigen::Matrix3d::Identity();
      mass.block<3, 3>(6 * i + 3, 6 * i + 3) = body.inertia;
      momentum.segment<6>(6 * i) = body.momentum;
      for (const Row& row : body.joint) {
        jacobian.block<1, 6>(at, 6 * i) = row.first.transpose();
        if (body.parent >= 0) jacobian.block<1, 6>(at, 6 * body.parent) = row.second.transpose();
        target[at] = row.target;
        softness[at] = row.softness;
        ++at;
      }
    }
  }

  /// Velocities, then impulses.
  Eigen::VectorXd solve() const {
    const Eigen::Index n = mass.rows(), m = jacobian.rows();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
    matrix.topLeftCorner(n, n) = mass;
    matrix.topRightCorner(n, m) = -jacobian.transpose();
    matrix.bottomLeftCorner(m, n) = jacobian;
    matrix.bottomRightCorner(m, m) = softness.asDiagonal();
    Eigen::VectorXd right(n + m);
    right << momentum, target;
    return matrix.fullPivLu().solve(right);
  }
};

}  // namespace rehearse
