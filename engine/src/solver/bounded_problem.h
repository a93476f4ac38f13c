// BoundedProblem: the impulses of constraints that push in one direction only, or up to a limit. Private to the engine.
//
// Find x with  A x + s = b  and, for each row, s = 0 where the impulse is inside its bounds, s >= 0 at the upper bound
// and s <= 0 at the lower one. Friction is bounded by its coefficient times the impulse of the contact's normal. A is
// symmetric and positive definite: the velocities that unit impulses cause.
//
// A sweep of projected Gauss-Seidel guesses which rows are at their bounds, and Newton steps solve the others exactly.
// The equation is piecewise linear, so a step with the right set of rows at bounds gives the solution (L. Qi and J.
// Sun, A nonsmooth version of Newton's method, Mathematical Programming 58, 1993).
//
// Contacts near their limit of friction can make these steps repeat themselves. Then the path of C. Lemke (Bimatrix
// Equilibrium Points and Mathematical Programming, Management Science 11, 1965) is followed. It solves A x + s = b - t
// d for changing t, with a constant d. For a large t each row that has bounds is at one of them. x is linear in t up to
// the value at which a row comes to a bound or leaves it. There the next part begins, in which t falls or rises. The
// last part ends with t = 0: contacts with friction have a solution there (M. Anitescu and F. Potra, Formulating
// Dynamic Multi-Rigid-Body Contact Problems with Friction, Nonlinear Dynamics 14, 1997).
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
    int steps;     // linear systems solved
  };

  /// Begins a problem of that many rows, with zeros.
  void reset(std::size_t rows);
  std::size_t rows() const { return bounds_.size(); }
  double& a(std::size_t row, std::size_t column) { return a_[row * rows() + column]; }
  double& b(std::size_t row) { return b_[row]; }
  Bounds& bounds(std::size_t row) { return bounds_[row]; }
  /// Before solve() an estimate, after it the solution.
  double& x(std::size_t row) { return x_[row]; }

  /// Solves until the error is at most `tolerance`. If that can't be reached, x is the best approximation found.
  Outcome solve(double tolerance);

 private:
  enum class At { inside, lower, upper };
  struct Place {
    At at;
    int free_index;  // among the rows that are inside
  };
  /// A row comes to a bound, or inside from one.
  struct Change {
    std::size_t row;
    At to;
  };
  /// A number that is linear in the path's t.
  struct Linear {
    double value = 0.0, slope = 0.0;
    double operator()(double t) const { return value + t * slope; }
  };

  double slack(std::size_t row) const;
  double lower(std::size_t row) const { return limit(row, bounds_[row].lower); }
  double upper(std::size_t row) const { return limit(row, bounds_[row].upper); }
  double limit(std::size_t row, double bound) const;
  double projected(std::size_t row, double value) const;
  void sweep();
  double error() const;
  double bound(std::size_t row) const;
  bool has_no_contact(std::size_t row) const;
  void classify();
  bool newton_step();
  bool accept(double tolerance, Outcome& outcome);
  bool factor_inside_rows();
  void substitute(std::vector<double>& right) const;
  bool factor_symmetric(std::size_t size);
  bool factor_general(std::size_t size);
  void begin_path();
  bool solve_along_path();
  Linear gap(Change change) const;
  template <typename Visit>
  void visit_changes(Visit&& visit) const;
  void make(Change change, double t);
  bool follow_path(Outcome& outcome);

  std::vector<double> a_, b_, x_;
  std::vector<Bounds> bounds_;
  // scratch of solve()
  std::vector<Place> places_;
  std::vector<std::size_t> inside_rows_, bounded_rows_, pivots_;
  bool is_symmetric_ = true;
  std::vector<double> matrix_, right_, diagonal_, best_;
  std::vector<double> push_, right_slopes_;  // of the path: d
  std::vector<Linear> impulses_, slacks_;
};

}  // namespace rehearse
