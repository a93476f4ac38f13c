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

TEST(Forest, SolvesRandomTreesAsDenseEquations) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Dice dice(seed);
    Forest forest;
    make_trees(dice, 1 + dice.below(25), forest);
    solve(forest);
    const Eigen::VectorXd expected = DenseEquations(forest).solve();
    Eigen::Index at = 6 * static_cast<Eigen::Index>(forest.bodies().size());
    const double scale = expected.cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < forest.bodies().size(); ++i) {
      const Vector6d velocity = expected.segment<6>(6 * static_cast<Eigen::Index>(i));
      EXPECT_LT((forest.velocity(static_cast<int>(i)) - velocity).norm(), 1e-8 * scale) << "seed " << seed;
      for (std::size_t r = 0; r < forest.bodies()[i].joint.size(); ++r)
        EXPECT_NEAR(forest.impulses(static_cast<int>(i))[r], expected[at++], 1e-6 * scale) << "seed " << seed;
    }
  }
}

TEST(Forest, WithoutJointsIsMomentumDividedByMass) {
  Dice dice(1);
  Forest forest;
  forest.bodies().push_back(random_body(dice, -1));
  solve(forest);
  const TreeBody& body = forest.bodies()[0];
  EXPECT_LT((body.mass * forest.velocity(0).head<3>() - body.momentum.head<3>()).norm(), 1e-14);
  EXPECT_LT((body.inertia * forest.velocity(0).tail<3>() - body.momentum.tail<3>()).norm(), 1e-14);
}

/// A column's effect on another column is the change of velocity that its impulse causes.
TEST(Forest, ProductsOfColumnsAreVelocitiesByImpulses) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Dice dice(seed);
    Forest forest;
    make_trees(dice, 12, forest);
    solve(forest);
    const int from = dice.below(12), to = dice.below(12);
    const int parent = forest.bodies()[static_cast<std::size_t>(from)].parent;
    const Vector6d push = dice.vector6(), push_parent = dice.vector6();
    const int pushed = forest.add_column(from, push, push_parent), felt = forest.add_unit_columns(to);
    const Vector6d before = forest.velocity(to);
    forest.bodies()[static_cast<std::size_t>(from)].momentum += push;
    if (parent >= 0) forest.bodies()[static_cast<std::size_t>(parent)].momentum += push_parent;
    forest.solve(0, 12);
    const Vector6d change = forest.velocity(to) - before;
    Vector6d product, transposed;
    forest.multiply(pushed, felt, product.data(), 6);
    forest.multiply(felt, pushed, transposed.data(), 1);
    EXPECT_LT((product - change).norm(), 1e-9 * (1.0 + change.norm())) << "seed " << seed;
    EXPECT_LT((transposed - change).norm(), 1e-9 * (1.0 + change.norm())) << "seed " << seed;
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> own;
    forest.multiply(felt, felt, own.data(), 6);
    EXPECT_LT((own - own.transpose()).norm(), 1e-12 * own.norm());
    double along;
    forest.multiply(pushed, pushed, &along, 1);
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

/// Whichever joints get or lose a row, the bits are those of a new factor.
TEST(Forest, FactorsChangedJointsAgainToTheSameBits) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Dice dice(seed);
    const int count = 1 + dice.below(25);
    Forest forest;
    make_trees(dice, count, forest);
    solve(forest);
    for (int round = 0; round < 5; ++round) {
      for (int change = dice.below(4); change-- > 0;) {
        const int body = dice.below(count);
        JointRows& joint = forest.bodies()[static_cast<std::size_t>(body)].joint;
        if (joint.size() == most_joint_rows || (dice.below(2) == 0 && !joint.empty()))
          joint.truncate(joint.size() - 1);
        else
          joint.add() = random_row(dice, 1e-2);
        forest.change_joint(body);
      }
      for (TreeBody& body : forest.bodies()) body.momentum = dice.vector6();
      forest.refactor(0, count);
      forest.solve(0, count);
      Forest other;
      other.bodies() = forest.bodies();
      solve(other);
      for (int body = 0; body < count; ++body) {
        ASSERT_EQ(forest.velocity(body), other.velocity(body)) << "seed " << seed;
        for (std::size_t r = 0; r < forest.bodies()[static_cast<std::size_t>(body)].joint.size(); ++r)
          ASSERT_EQ(forest.impulses(body)[r], other.impulses(body)[r]) << "seed " << seed;
      }
      Eigen::Matrix<double, 6, 6> product, expected;
      const int body = dice.below(count);
      forest.clear_columns();
      forest.multiply(forest.add_unit_columns(body), 0, product.data(), 6);
      other.multiply(other.add_unit_columns(body), 0, expected.data(), 6);
      ASSERT_EQ(product, expected) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace rehearse
