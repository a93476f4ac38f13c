// Drives with limits, and rows between bodies of one or two trees.

#include "solver/island.h"

#include <gtest/gtest.h>

#include "solver_problems.h"

namespace rehearse {
namespace {

/// A hinge about z through the centres of two bodies, the second of which is the world.
TreeBody wheel(double inertia, double angular_momentum) {
  TreeBody body;
  body.mass = 1.0;
  body.inertia = inertia * Eigen::Matrix3d::Identity();
  body.momentum[5] = angular_momentum;
  for (int k = 0; k < 5; ++k) {
    Row& row = body.joint.add();
    row.first[k] = 1.0;
  }
  return body;
}

LimitedDrive drive_of(int body, double target, double limit, LimitedDrive::State state) {
  LimitedDrive drive;
  drive.body = body;
  drive.row.first[5] = 1.0;
  drive.row.second[5] = -1.0;
  drive.row.target = target;
  drive.limit = limit;
  drive.state = state;
  return drive;
}

/// The velocity after a step of a wheel at rest, of inertia 2, with a drive of that limit towards 1 rad/s.
double driven(double limit, LimitedDrive::State assumed, LimitedDrive* after = nullptr) {
  Forest forest;
  forest.bodies().push_back(wheel(2.0, 0.0));
  Island island(forest);
  island.add_trees(0, 1);
  island.add_drive(drive_of(0, 1.0, limit, assumed));
  island.solve(1e-12);
  if (after) *after = island.drives()[0];
  return forest.velocity(0)[5];
}

TEST(ALimitedDrive, ReachesItsTargetOrItsLimitWhateverIsAssumed) {
  using enum LimitedDrive::State;
  for (const LimitedDrive::State assumed : {holds, at_lower, at_upper, bounded}) {
    LimitedDrive after;
    EXPECT_NEAR(driven(3.0, assumed, &after), 1.0, 1e-14);
    EXPECT_NEAR(after.impulse, 2.0, 1e-14);
    EXPECT_NEAR(driven(1.0, assumed, &after), 0.5, 1e-14);
    EXPECT_NEAR(after.impulse, 1.0, 1e-14);
  }
}

/// The drives of a chain, some of which reach their limits: the same velocities from every assumption.
TEST(LimitedDrives, HaveOneSolution) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::vector<Vector6d> expected;
    for (int variant = 0; variant < 4; ++variant) {
      Dice dice(seed);
      Forest forest;
      make_trees(dice, 10, forest);
      for (TreeBody& body : forest.bodies()) body.joint.truncate(most_joint_rows - 1);
      Island island(forest);
      island.add_trees(0, 10);
      for (int body = 0; body < 10; ++body) {
        if (forest.bodies()[static_cast<std::size_t>(body)].parent < 0) continue;
        LimitedDrive drive;
        drive.body = body;
        drive.row = random_row(dice);
        drive.limit = dice.uniform(0.0, 0.5);
        drive.state = static_cast<LimitedDrive::State>((variant + body * (variant / 2)) % 4);
        island.add_drive(drive);
      }
      EXPECT_LT(island.solve(1e-13).error, 1e-10);
      for (int body = 0; body < 10; ++body) {
        if (variant == 0) expected.push_back(forest.velocity(body));
        EXPECT_LT((forest.velocity(body) - expected[static_cast<std::size_t>(body)]).norm(), 1e-7)
            << "seed " << seed << ", variant " << variant;
      }
    }
  }
}

/// Rows with unlimited impulses between bodies of any trees are further equations.
TEST(AnIsland, ClosesLoopsAsDenseEquations) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    Dice dice(seed);
    Forest forest;
    make_trees(dice, 8, forest);
    Island island(forest);
    DenseEquations dense(forest);
    island.add_trees(0, 8);
    for (int i = 0; i < 4; ++i) {
      BoundedRow row;
      row.body = dice.below(8);
      row.other = dice.below(9) - 1;
      if (row.other == row.body) continue;
      row.row = random_row(dice);
      island.add_row(row);
      const Eigen::Index at = dense.jacobian.rows();
      dense.jacobian.conservativeResize(at + 1, Eigen::NoChange);
      dense.jacobian.row(at).setZero();
      dense.jacobian.block<1, 6>(at, 6 * row.body) = row.row.first.transpose();
      if (row.other >= 0) dense.jacobian.block<1, 6>(at, 6 * row.other) = row.row.second.transpose();
      dense.target.conservativeResize(at + 1);
      dense.softness.conservativeResize(at + 1);
      dense.target[at] = row.row.target;
      dense.softness[at] = row.row.softness;
    }
    EXPECT_LT(island.solve(1e-12).error, 1e-8) << "seed " << seed;
    const Eigen::VectorXd expected = dense.solve();
    const double scale = expected.cwiseAbs().maxCoeff();
    for (int body = 0; body < 8; ++body)
      EXPECT_LT((forest.velocity(body) - expected.segment<6>(6 * body)).norm(), 1e-7 * scale) << "seed " << seed;
  }
}

}  // namespace
}  // namespace rehearse
