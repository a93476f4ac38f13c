// Drives with limits, and rows between bodies of one or two trees.

#include "solver/island.h"

#include <gtest/gtest.h>

#include <utility>

#include "solver_problems.h"

namespace rehearse {
namespace {

/// A hinge about z through the centre of a body, on the world.
TreeBody wheel(double inertia, double angular_momentum) {
  TreeBody body;
  body.mass = 1.0;
  body.inertia = inertia * Eigen::Matrix3d::Identity();
  body.momentum[5] = angular_momentum;
  body.joint.add(Vector6d::Unit(5));
  return body;
}

LimitedDrive drive_of(int body, double target, double limit, LimitedDrive::State state) {
  LimitedDrive drive;
  drive.body = body;
  drive.drive.target = target;
  drive.limit = limit;
  drive.state = state;
  return drive;
}

/// The velocity after a step of a wheel at rest, of inertia 2, with a drive of that limit towards 1 rad/s.
double driven(double limit, LimitedDrive::State assumed, LimitedDrive* after = nullptr) {
  Forest forest;
  forest.bodies().push_back(wheel(2.0, 0.0));
  forest.arrange();
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
      for (TreeBody& body : forest.bodies()) body.drive.reset();
      Island island(forest);
      island.add_trees(0, 10);
      for (int body = 0; body < 10; ++body) {
        if (forest.bodies()[static_cast<std::size_t>(body)].joint.coordinates() != 1) continue;
        const auto state = static_cast<LimitedDrive::State>((variant + body * (variant / 2)) % 4);
        LimitedDrive drive = drive_of(body, dice.uniform(-1.0, 1.0), dice.uniform(0.0, 0.5), state);
        drive.drive.softness = 1e-7;
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
      Eigen::VectorXd along = Eigen::VectorXd::Zero(6 * 8);
      along.segment<6>(6 * row.body) = row.row.first;
      if (row.other >= 0) along.segment<6>(6 * row.other) = row.row.second;
      dense.add_row(along, row.row.target, row.row.softness);
    }
    EXPECT_LT(island.solve(1e-12).error, 1e-8) << "seed " << seed;
    const Eigen::VectorXd expected = dense.solve();
    const double scale = expected.cwiseAbs().maxCoeff();
    for (int body = 0; body < 8; ++body)
      EXPECT_LT((forest.velocity(body) - expected.segment<6>(6 * body)).norm(), 1e-7 * scale) << "seed " << seed;
  }
}

/// Two wheels, 2 : 1, of which the first is driven by 1 N·m·s.
TEST(AnIsland, CouplesJointsWithAnImpulseOnBoth) {
  Forest forest;
  forest.bodies() = {wheel(1.0, 1.0), wheel(1.0, 0.0)};
  forest.arrange();
  Island island(forest);
  island.add_trees(0, 1);
  island.add_trees(1, 2);
  JointRow row;
  row.body = 1;
  row.other = 0;
  row.factor = -2.0;
  island.add_row(row);
  EXPECT_LT(island.solve(1e-12).error, 1e-12);
  EXPECT_NEAR(forest.rate(0), 0.2, 1e-15);
  EXPECT_NEAR(forest.rate(1), 0.4, 1e-15);
  EXPECT_NEAR(island.joint_rows()[0].impulse, 0.4, 1e-15);
}

/// The rate after a step, and by which the joint moves in it, of a wheel of inertia 1 with that momentum.
std::pair<double, double> stopped(double momentum, const Stop& stop) {
  Forest forest;
  forest.bodies().push_back(wheel(1.0, momentum));
  forest.arrange();
  Island island(forest);
  island.add_trees(0, 1);
  island.add_stop(stop);
  island.solve(1e-12);
  return {forest.rate(0), island.moving_velocity(0)[5]};
}

TEST(AStop, LimitsARateWhateverIsAssumed) {
  for (const Stop::State assumed : {Stop::State::free, Stop::State::at_lower, Stop::State::at_upper}) {
    Stop stop;
    stop.lowest = -0.5;
    stop.highest = 0.25;
    stop.state = assumed;
    EXPECT_NEAR(stopped(0.1, stop).first, 0.1, 1e-15);
    EXPECT_NEAR(stopped(3.0, stop).first, 0.25, 1e-15);
    EXPECT_NEAR(stopped(-3.0, stop).first, -0.5, 1e-15);
  }
}

TEST(AStop, MovesAJointBackWithoutMomentum) {
  Stop stop;
  stop.lowest = -10.0;
  stop.highest = -0.5;
  stop.corrects = true;
  const auto [rate, moves] = stopped(2.0, stop);
  EXPECT_NEAR(rate, 0.0, 1e-15);
  EXPECT_NEAR(moves, -0.5, 1e-15);
  EXPECT_NEAR(stopped(-3.0, stop).first, -3.0, 1e-15);  // it returns by itself
}

}  // namespace
}  // namespace rehearse
