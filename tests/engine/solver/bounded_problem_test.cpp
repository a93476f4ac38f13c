// Solutions satisfy the complementarity conditions, and are those of problems small enough to try all cases.

#include "solver/bounded_problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "solver_problems.h"

namespace rehearse {
namespace {

/// A problem of `rows` rows whose matrix has the given rank and a small softness.
BoundedProblem random_problem(Dice& dice, int rows, int rank, double softness = 1e-7) {
  Eigen::MatrixXd root(rows, rank);
  for (double& x : root.reshaped()) x = dice.uniform(-1.0, 1.0);
  const Eigen::MatrixXd a = root * root.transpose() + softness * Eigen::MatrixXd::Identity(rows, rows);
  const Eigen::VectorXd b = root * Eigen::VectorXd::NullaryExpr(rank, [&] { return dice.uniform(-2.0, 2.0); });
  BoundedProblem problem;
  problem.reset(static_cast<std::size_t>(rows));
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) problem.a(i, j) = a(i, j);
    problem.b(i) = b[i];
  }
  return problem;
}

double slack(BoundedProblem& problem, std::size_t row) {
  double s = problem.b(row);
  for (std::size_t j = 0; j < problem.rows(); ++j) s -= problem.a(row, j) * problem.x(j);
  return s;
}

void expect_solved(BoundedProblem& problem, double tolerance, const std::string& which) {
  for (std::size_t i = 0; i < problem.rows(); ++i) {
    const BoundedProblem::Bounds& bounds = problem.bounds(i);
    const double factor = bounds.normal < 0 ? 1.0 : problem.x(static_cast<std::size_t>(bounds.normal));
    const double lower = factor == 0.0 ? 0.0 : bounds.lower * factor,
                 upper = factor == 0.0 ? 0.0 : bounds.upper * factor;
    EXPECT_GE(problem.x(i), lower - tolerance) << which << ", row " << i;
    EXPECT_LE(problem.x(i), upper + tolerance) << which << ", row " << i;
    const double s = slack(problem, i);
    if (s > tolerance) {
      EXPECT_NEAR(problem.x(i), upper, tolerance) << which << ", row " << i;
    }
    if (s < -tolerance) {
      EXPECT_NEAR(problem.x(i), lower, tolerance) << which << ", row " << i;
    }
  }
}

TEST(ABoundedProblem, OfEqualitiesIsALinearSystem) {
  Dice dice(3);
  BoundedProblem problem = random_problem(dice, 9, 9);
  EXPECT_LT(problem.solve(1e-12).error, 1e-12);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(slack(problem, i), 0.0, 1e-12);
}

TEST(ABoundedProblem, WithOneSidedRowsIsSolved) {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    Dice dice(seed);
    const int rows = 1 + dice.below(20);
    BoundedProblem problem = random_problem(dice, rows, 1 + dice.below(rows));
    for (int i = 0; i < rows; ++i) {
      if (dice.below(2) == 0) problem.bounds(i) = {0.0, BoundedProblem::infinite, -1};
      if (dice.below(4) == 0) problem.bounds(i) = {-dice.uniform(0.0, 1.0), dice.uniform(0.0, 1.0), -1};
    }
    const std::string which = "seed " + std::to_string(seed);
    const double error = problem.solve(1e-10).error;
    double most = 1.0;  // rows that contradict each other have impulses that only the softness limits
    for (int i = 0; i < rows; ++i) most = std::max(most, std::abs(problem.x(i)));
    EXPECT_LT(error, 1e-7 * most) << which;
    expect_solved(problem, 1e-6 * most, which);
  }
}

/// Contacts as of two feet: four points each with a normal and two rows of friction, of two rigid bodies, in random
/// directions. Newton steps alone leave some of them wrong by the size of the impulses.
TEST(ABoundedProblem, OfContactsWithFrictionIsSolved) {
  for (std::uint32_t seed = 0; seed < 3000; ++seed) {
    Dice dice(seed);
    BoundedProblem problem = random_problem(dice, 24, 12);
    const double coefficient = dice.uniform(0.05, 1.2);
    for (int contact = 0; contact < 8; ++contact) {
      problem.bounds(3 * contact) = {0.0, BoundedProblem::infinite, -1};
      for (int k = 1; k < 3; ++k) problem.bounds(3 * contact + k) = {-coefficient, coefficient, 3 * contact};
    }
    EXPECT_LE(problem.solve(1e-10).error, 1e-10) << "seed " << seed;
    expect_solved(problem, 1e-6, "seed " + std::to_string(seed));
  }
}

TEST(ABoundedProblem, EstimatesTheSolutionThatItStartsFrom) {
  Dice dice(5);
  BoundedProblem problem = random_problem(dice, 12, 12);
  for (int i = 0; i < 12; ++i) problem.bounds(i) = {0.0, BoundedProblem::infinite, -1};
  problem.solve(1e-12);
  const BoundedProblem::Outcome again = problem.solve(1e-12);
  EXPECT_EQ(again.steps, 1);
}

TEST(ABoundedProblem, WithoutFrictionPastASeparatedContact) {
  BoundedProblem problem;
  problem.reset(2);
  problem.a(0, 0) = problem.a(1, 1) = 1.0;
  problem.b(0) = -1.0;  // separates
  problem.b(1) = 1.0;   // slides
  problem.bounds(0) = {0.0, BoundedProblem::infinite, -1};
  problem.bounds(1) = {-BoundedProblem::infinite, BoundedProblem::infinite, 0};  // friction without limit
  EXPECT_EQ(problem.solve(1e-12).error, 0.0);
  EXPECT_EQ(problem.x(0), 0.0);
  EXPECT_EQ(problem.x(1), 0.0);
}

/// Equal rows without softness have no inverse; sweeps don't need it.
TEST(ABoundedProblem, WithEqualRowsIsSolvedBySweeps) {
  BoundedProblem problem;
  problem.reset(3);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) problem.a(i, j) = i / 2 == j / 2 ? 2.0 : 1.0;
    problem.b(i) = 1.0;
  }
  EXPECT_LE(problem.solve(1e-12).error, 1e-12);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(slack(problem, i), 0.0, 1e-11);
}

TEST(ABoundedProblem, OfNumbersThatArentFiniteEnds) {
  BoundedProblem problem;
  problem.reset(3);
  for (std::size_t i = 0; i < 3; ++i) problem.a(i, i) = problem.b(i) = std::nan("");
  EXPECT_FALSE(problem.solve(1e-12).error <= 1e-12);
}

}  // namespace
}  // namespace rehearse
