// The solution along the trees equals that of the dense equations.

#include <gtest/gtest.h>

#include "solver_problems.h"

namespace rehearse {
namespace {

void solve(Forest& forest) {
  const int count = static_cast<int>(forest.bodies().size());
  forest.factor(0, count);
  forest.solve(0, count);
}

/// What a body's impulse is for its parent.
Vector6d shifted(const TreeBody& body, const Vector6d& impulse) {
  Vector6d of_parent = impulse;
  of_parent.tail<3>() += body.joint.arm.cross(Eigen::Vector3d(impulse.head<3>()));
  return of_parent;
}

TEST(Forest, SolvesRandomTreesAsDenseEquations) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Dice dice(seed);
    Forest forest;
    make_trees(dice, 1 + dice.below(25), forest);
    solve(forest);
    const Eigen::VectorXd expected = DenseEquations(forest).solve();
    const double scale = 1.0 + expected.cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < forest.bodies().size(); ++i) {
      const Vector6d velocity = expected.segment<6>(6 * static_cast<Eigen::Index>(i));
      EXPECT_LT((forest.velocity(static_cast<int>(i)) - velocity).norm(), 1e-7 * scale) << "seed " << seed;
    }
  }
}

/// The impulses of all joints on a body are the change of its momentum, and each joint's impulse along its coordinate
/// is that of its damper, its drive and what is known.
TEST(Forest, FindsTheImpulsesOfJoints) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    Dice dice(seed);
    Forest forest;
    const int count = 1 + dice.below(25);
    make_trees(dice, count, forest);
    solve(forest);
    const Vector6d push = dice.vector6();
    const int pushed = dice.below(count);
    forest.push(pushed, push);
    forest.descend(0, count);
    forest.find_wrenches(0, count);
    for (int i = 0; i < count; ++i) {
      const TreeBody& body = forest.bodies()[static_cast<std::size_t>(i)];
      const Vector6d& v = forest.velocity(i);
      Vector6d rest = spatial(body.mass * v.head<3>(), body.inertia * v.tail<3>()) - body.momentum - forest.wrench(i);
      if (i == pushed) rest -= push;
      for (int child = i + 1; child < count; ++child) {
        const TreeBody& other = forest.bodies()[static_cast<std::size_t>(child)];
        if (other.parent == i) rest += shifted(other, forest.wrench(child));
      }
      EXPECT_LT(rest.norm(), 1e-9 * (1.0 + forest.wrench(i).norm())) << "seed " << seed;
      for (int k = 0; k < body.joint.coordinates(); ++k) {
        double known = 0.0;
        if (body.joint.coordinates() == 1) {
          known = body.offset + body.push - body.gain * forest.rate(i);
          if (body.drive) known += forest.drive_impulse(i);
        }
        EXPECT_NEAR(dot6(body.joint.axis(k), forest.wrench(i)), known, 1e-8 * (1.0 + forest.wrench(i).norm()))
            << "seed " << seed;
      }
    }
  }
}

TEST(Forest, WithoutJointsIsMomentumDividedByMass) {
  Dice dice(1);
  Forest forest;
  forest.bodies().push_back(random_body(dice, -1));
  forest.bodies()[0].joint = JointMotion::free();
  forest.arrange();
  solve(forest);
  const TreeBody& body = forest.bodies()[0];
  EXPECT_LT((body.mass * forest.velocity(0).head<3>() - body.momentum.head<3>()).norm(), 1e-14);
  EXPECT_LT((body.inertia * forest.velocity(0).tail<3>() - body.momentum.tail<3>()).norm(), 1e-14);
}

/// A drive without softness moves its joint exactly, and one that is stiff has all digits of its impulse.
TEST(Forest, HoldsStiffDrives) {
  for (const double softness : {0.0, 1e-14, 1e-7}) {
    Forest forest;
    TreeBody& wheel = forest.bodies().emplace_back();
    wheel.mass = 1.0;
    wheel.inertia = 2.0 * Eigen::Matrix3d::Identity();
    wheel.joint.add(Vector6d::Unit(5));
    wheel.drive = {3.0, softness};
    forest.arrange();
    solve(forest);
    EXPECT_NEAR(forest.rate(0), 3.0 / (1.0 + 2.0 * softness), 1e-15);
    EXPECT_NEAR(forest.drive_impulse(0), 6.0 / (1.0 + 2.0 * softness), 1e-14);
  }
}

/// A column's effect on another column is the change of velocity that its impulse causes.
TEST(Forest, ProductsOfColumnsAreVelocitiesByImpulses) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Dice dice(seed);
    Forest forest;
    make_trees(dice, 12, forest);
    solve(forest);
    const int from = dice.below(12), to = dice.below(12);
    const Vector6d push = dice.vector6();
    const int pushed = forest.add_body_columns(from), felt = forest.add_body_columns(to);
    const Vector6d before = forest.velocity(to);
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> product, transposed, own;
    forest.multiply(pushed, felt, product.data(), 6);
    forest.multiply(felt, pushed, transposed.data(), 6);
    EXPECT_LT((product - transposed.transpose()).norm(), 1e-12 * (1.0 + product.norm())) << "seed " << seed;
    forest.push(from, push);
    forest.descend(0, 12);
    const Vector6d change = forest.velocity(to) - before;
    EXPECT_LT((transposed * push - change).norm(), 1e-9 * (1.0 + change.norm())) << "seed " << seed;
    forest.multiply(felt, felt, own.data(), 6);
    EXPECT_LT((own - own.transpose()).norm(), 1e-12 * (1.0 + own.norm()));
  }
}

/// The same of a joint's column: its effect on itself and on a body.
TEST(Forest, ProductsOfJointColumnsAreRatesByImpulses) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Dice dice(seed);
    Forest forest;
    make_trees(dice, 12, forest);
    solve(forest);
    const int from = dice.below(12), to = dice.below(12);
    if (forest.bodies()[static_cast<std::size_t>(from)].joint.coordinates() != 1) continue;
    const int pushed = forest.add_joint_column(from), felt = forest.add_body_columns(to);
    const Vector6d before = forest.velocity(to);
    const double rate = forest.rate(from);
    forest.push_joint(from, 0.3);
    forest.descend(0, 12);
    Vector6d product;
    double along;
    forest.multiply(pushed, felt, product.data(), 6);
    forest.multiply(pushed, pushed, &along, 1);
    const Vector6d change = forest.velocity(to) - before;
    EXPECT_LT((0.3 * product - change).norm(), 1e-9 * (1.0 + change.norm())) << "seed " << seed;
    EXPECT_NEAR(forest.rate(from) - rate, 0.3 * along, 1e-9 * (1.0 + along)) << "seed " << seed;
    EXPECT_GT(along, 0.0);
  }
}

TEST(Forest, SolvesEachTreeByItself) {
  Dice dice(7);
  Forest forest;
  make_trees(dice, 20, forest);
  solve(forest);
  std::vector<Vector6d> whole;
  for (int i = 0; i < 20; ++i) whole.push_back(forest.velocity(i));
  for (int first = 0, last = 1; first < 20; first = last++) {
    while (last < 20 && forest.bodies()[static_cast<std::size_t>(last)].parent >= 0) ++last;
    forest.factor(first, last);
    forest.solve(first, last);
  }
  for (int i = 0; i < 20; ++i) EXPECT_EQ(forest.velocity(i), whole[static_cast<std::size_t>(i)]);
}

/// Whichever joints get or lose a drive, the bits are those of a new factor.
TEST(Forest, FactorsChangedJointsAgainToTheSameBits) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Dice dice(seed);
    const int count = 1 + dice.below(25);
    Forest forest;
    make_trees(dice, count, forest);
    solve(forest);
    for (int round = 0; round < 5; ++round) {
      for (int change = dice.below(4); change-- > 0;) {
        const int at = dice.below(count);
        TreeBody& body = forest.bodies()[static_cast<std::size_t>(at)];
        if (body.joint.coordinates() != 1) continue;
        if (body.drive)
          body.drive.reset();
        else
          body.drive = {dice.uniform(-1.0, 1.0), 1e-2};
        forest.change_drive(at);
      }
      for (TreeBody& body : forest.bodies()) body.momentum = dice.vector6();
      forest.refactor(0, count);
      forest.solve(0, count);
      Forest other;
      other.bodies() = forest.bodies();
      other.arrange();
      solve(other);
      for (int body = 0; body < count; ++body) {
        ASSERT_EQ(forest.velocity(body), other.velocity(body)) << "seed " << seed;
        if (forest.bodies()[static_cast<std::size_t>(body)].joint.coordinates() != 1) continue;
        ASSERT_EQ(forest.drive_impulse(body), other.drive_impulse(body)) << "seed " << seed;
      }
      Eigen::Matrix<double, 6, 6, Eigen::RowMajor> product, expected;
      const int body = dice.below(count);
      forest.clear_columns();
      forest.multiply(forest.add_body_columns(body), 0, product.data(), 6);
      other.multiply(other.add_body_columns(body), 0, expected.data(), 6);
      ASSERT_EQ(product, expected) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace rehearse
