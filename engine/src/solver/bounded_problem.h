// BoundedProblem: the impulses of constraints that push in one direction only, or up to a limit. Private to the engine.
//
// Find x with  A x + s = b  and, for each row, s = 0 where the impulse is inside its bounds, s >= 0 at the upper bound
// and s <= 0 at the lower one. Friction is bounded by its coefficient times the impulse of the contact's normal. A is
// symmetric and positive definite: the velocities that unit impulses cause.
//
// A sweep of projected Gauss-Seidel guesses which rows are at their bounds, and Newton steps solve the others exactly.
// The equation is piecewise linear, so a step with the right set of rows at bounds gives the solution (L. Qi and J.
// Sun, A nonsmooth version of Newton's method, Mathematical Programming 58, 1993). Feet that push against each other
// can make these steps repeat themselves. Then friction's bounds are kept constant, which is a convex problem that
// always has an end, and follow the normal impulses from round to round.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace rehearse {

class BoundedProblem {
 public:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  /// The bounds of an impulse. With a `normal`, both are multiplied by that row's impulse.
  struct Bounds {
    double lower = -infinite;
    double upper = infinite;
    int normal = -1;  // index of the contact's normal row, less than this row's; -1: none
  };

  struct Outcome {
    double error;  // the largest change of an impulse by a projected step along one row
    int newton_steps;
  };

  /// Begins a problem of that many rows, with zeros.
  void reset(std::size_t rows);
  std::size_t rows() const { return bounds_.size(); }
  double& a(std::size_t row, std::size_t column) { return a_[row * rows() + column]; }
  double& b(std::size_t row) { return b_[row]; }
  Bounds& bounds(std::size_t row) { return bounds_[row]; }
  /// Before solve() an estimate, after it the solution.
  double& x(std::size_t row) { return x_[row]; }

  static constexpr int most_steps = 3000;
  /// Solves until the error is at most `tolerance`. If that isn't reached in about `steps` Newton steps, x is the best
  /// approximation found.
  Outcome solve(double tolerance, int steps = most_steps);

 private:
  enum class At { inside, fixed, sliding };
  /// The place of a row in a Newton step: inside its bounds, fixed to a value, or at a multiple of its normal's
  /// impulse.
  struct Place {
    At at;
    double value;  // or factor of the normal's impulse
    int free_index;
  };

  double slack(std::size_t row) const;
  double lower(std::size_t row) const { return limit(row, bounds_[row].lower); }
  double upper(std::size_t row) const { return limit(row, bounds_[row].upper); }
  double limit(std::size_t row, double bound) const;
  double projected(std::size_t row, double value) const;
  void sweep();
  double error() const;
  void classify();
  bool newton_step();
  double decrease() const;
  double clamped(std::size_t row, double value) const;
  bool step_along_free_rows();
  void solve_box(double tolerance, Outcome& outcome);
  bool solve_in_rounds(double tolerance, int steps, Outcome& outcome);
  bool accept(double tolerance, Outcome& outcome);
  bool solve_symmetric(std::size_t size);
  bool solve_general(std::size_t size);

  std::vector<double> a_, b_, x_;
  std::vector<Bounds> bounds_;
  // scratch of solve()
  std::vector<Place> places_;
  std::vector<std::size_t> free_rows_, bounded_rows_;  // inside their bounds, and the others
  std::vector<double> matrix_, right_, diagonal_, best_, start_, before_;
  std::vector<double> low_, high_, slacks_, from_, normals_;
};

}  // namespace rehearse
