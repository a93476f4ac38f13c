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

/// A joint of that many coordinates along random motions.
inline JointMotion random_joint(Dice& dice, int coordinates) {
  JointMotion joint;
  joint.arm = dice.vector6().head<3>();
  joint.bias = dice.vector6();
  for (int i = 0; i < coordinates; ++i) joint.add(dice.vector6());
  return joint;
}

/// Trees of `count` bodies: a body is the root of a tree, free or on a joint with the world, or has an earlier parent.
/// Of the joints with one coordinate some have a damper, a known impulse and a drive.
inline void make_trees(Dice& dice, int count, Forest& forest) {
  forest.bodies().clear();
  int root = 0;
  for (int i = 0; i < count; ++i) {
    const bool begins = i == 0 || dice.below(6) == 0;
    if (begins) root = i;
    TreeBody body = random_body(dice, begins ? -1 : root + dice.below(i - root));
    const int coordinates = dice.below(3) > 0 ? 1 : dice.below(5);
    body.joint = begins && dice.below(2) == 0 ? JointMotion::free() : random_joint(dice, coordinates);
    if (body.joint.coordinates() == 1) {
      if (dice.below(3) == 0) body.gain = dice.uniform(0.0, 2.0);
      if (dice.below(3) == 0) body.offset = dice.uniform(-1.0, 1.0);
      if (dice.below(3) == 0) body.push = dice.uniform(-1.0, 1.0);
      if (dice.below(3) == 0) body.drive = {dice.uniform(-1.0, 1.0), 1e-5};
    }
    forest.bodies().push_back(body);
  }
  forest.arrange();
}

/// The equations of trees as dense matrices. The velocities of all bodies are `motion` q + `bias`, and the coordinates
/// q solve `inertia` q = `impulse`, with further rows.
struct DenseEquations {
  Eigen::MatrixXd motion, inertia;
  Eigen::VectorXd bias, impulse;
  Eigen::MatrixXd rows;  // of all velocities
  Eigen::VectorXd target, softness;

  explicit DenseEquations(const Forest& forest) {
    const auto& bodies = forest.bodies();
    const auto count = static_cast<Eigen::Index>(bodies.size());
    Eigen::Index coordinates = 0;
    for (const TreeBody& body : bodies) coordinates += body.joint.coordinates();
    motion = Eigen::MatrixXd::Zero(6 * count, coordinates);
    bias = Eigen::VectorXd::Zero(6 * count);
    inertia = Eigen::MatrixXd::Zero(coordinates, coordinates);
    impulse = Eigen::VectorXd::Zero(coordinates);
    rows.resize(0, 6 * count);
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(6 * count, 6 * count);
    Eigen::VectorXd momentum(6 * count);
    Eigen::Index at = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const TreeBody& body = bodies[static_cast<std::size_t>(i)];
      mass.block<3, 3>(6 * i, 6 * i) = body.mass * Eigen::Matrix3d::Identity();
      mass.block<3, 3>(6 * i + 3, 6 * i + 3) = body.inertia;
      momentum.segment<6>(6 * i) = body.momentum;
      if (body.parent >= 0) {
        Eigen::Matrix<double, 6, 6> shift = Eigen::Matrix<double, 6, 6>::Identity();
        for (int k = 0; k < 3; ++k) shift.block<3, 1>(0, 3 + k) = Eigen::Vector3d::Unit(k).cross(body.joint.arm);
        motion.middleRows<6>(6 * i) = shift * motion.middleRows<6>(6 * body.parent);
        bias.segment<6>(6 * i) = shift * bias.segment<6>(6 * body.parent);
      }
      bias.segment<6>(6 * i) += body.joint.bias;
      for (int k = 0; k < body.joint.coordinates(); ++k, ++at) {
        motion.block<6, 1>(6 * i, at) += body.joint.axis(k);
        inertia(at, at) = body.gain + (body.drive ? 1.0 / body.drive->softness : 0.0);
        impulse[at] = body.offset + body.push + (body.drive ? body.drive->target / body.drive->softness : 0.0);
      }
    }
    inertia += motion.transpose() * mass * motion;
    impulse += motion.transpose() * (momentum - mass * bias);
  }

  void add_row(const Eigen::VectorXd& row, double at, double soft) {
    const Eigen::Index count = rows.rows();
    rows.conservativeResize(count + 1, Eigen::NoChange);
    target.conservativeResize(count + 1);
    softness.conservativeResize(count + 1);
    rows.row(count) = row.transpose();
    target[count] = at;
    softness[count] = soft;
  }

  /// The velocities of all bodies.
  Eigen::VectorXd solve() const {
    const Eigen::Index n = inertia.rows(), m = rows.rows();
    const Eigen::MatrixXd along = rows * motion;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n + m, n + m);
    matrix.topLeftCorner(n, n) = inertia;
    matrix.topRightCorner(n, m) = -along.transpose();
    matrix.bottomLeftCorner(m, n) = along;
    matrix.bottomRightCorner(m, m) = softness.asDiagonal();
    Eigen::VectorXd right(n + m);
    right.head(n) = impulse;
    right.tail(m) = target - rows * bias;
    return motion * matrix.fullPivLu().solve(right).head(n) + bias;
  }
};

}  // namespace rehearse
