#include "bounded_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rehearse {
namespace {

constexpr int most_newton = 8;       // steps with all bounds free to change
constexpr int most_rounds = 200;     // of the fallback
constexpr int most_box_steps = 100;  // in a round
constexpr int polishing = 4;         // Newton steps after each round
constexpr double smallest_pivot = 1e-13;

/// Newton steps in all rounds. A step costs the third power of the rows: a crowd of contacts gets fewer, so that a step
/// of the world stays within some tenths of a second.
int affordable(int steps, std::size_t rows) {
  constexpr double least = 100.0, ample = 48.0;  // ample: rows for which all are affordable
  const double share = ample / std::max(ample, static_cast<double>(rows));
  return static_cast<int>(std::max(std::min<double>(least, steps), steps * share * share * share));
}

/// The share by which the normals' impulses follow in a round: less in later ones, which rows that swing need.
double share_of_round(int round) {
  constexpr int many = 20, very_many = 60;
  return round < many ? 0.7 : round < very_many ? 0.3 : 0.1;
}

}  // namespace

void BoundedProblem::reset(std::size_t rows) {
  a_.assign(rows * rows, 0.0);
  b_.assign(rows, 0.0);
  x_.assign(rows, 0.0);
  bounds_.assign(rows, {});
}

double BoundedProblem::limit(std::size_t row, double bound) const {
  const int normal = bounds_[row].normal;
  if (normal < 0) return bound;
  return x_[normal] > 0.0 ? bound * x_[normal] : 0.0;  // not infinity times zero
}

double BoundedProblem::projected(std::size_t row, double value) const {
  return std::min(std::max(value, lower(row)), upper(row));
}

double BoundedProblem::slack(std::size_t row) const {
  const double* a = &a_[row * rows()];
  double even = b_[row], odd = 0.0;  // two sums: the second addition needn't wait for the first
  std::size_t j = 0;
  for (; j + 1 < rows(); j += 2) {
    even -= a[j] * x_[j];
    odd -= a[j + 1] * x_[j + 1];
  }
  if (j < rows()) even -= a[j] * x_[j];
  return even + odd;
}

void BoundedProblem::sweep() {
  for (std::size_t i = 0; i < rows(); ++i) x_[i] = projected(i, x_[i] + slack(i) / a_[i * rows() + i]);
}

/// Not a number if any of the numbers isn't one.
double BoundedProblem::error() const {
  double worst = 0.0;
  for (std::size_t i = 0; i < rows(); ++i) {
    const double change = std::abs(projected(i, x_[i] + slack(i) / a_[i * rows() + i]) - x_[i]);
    if (!(change <= worst)) worst = change;
  }
  return worst;
}

/// The set of a Newton step: where a step along each row alone leads.
void BoundedProblem::classify() {
  places_.resize(rows());
  free_rows_.clear();
  bounded_rows_.clear();
  for (std::size_t i = 0; i < rows(); ++i) {
    Place& place = places_[i];
    const Bounds& bounds = bounds_[i];
    const double wanted = x_[i] + slack(i) / a_[i * rows() + i];
    if (bounds.normal >= 0 && places_[bounds.normal].at == At::fixed)
      place = {At::fixed, 0.0, -1};  // no contact, no friction
    else if (wanted > upper(i))
      place = {bounds.normal >= 0 ? At::sliding : At::fixed, bounds.upper, -1};
    else if (wanted < lower(i))
      place = {bounds.normal >= 0 ? At::sliding : At::fixed, bounds.lower, -1};
    else
      place = {At::inside, 0.0, static_cast<int>(free_rows_.size())};
    (place.at == At::inside ? free_rows_ : bounded_rows_).push_back(i);
  }
}

/// Solves the rows that are inside their bounds; the others are at bounds. Returns false if the matrix is singular.
bool BoundedProblem::newton_step() {
  classify();
  const std::size_t size = free_rows_.size();
  matrix_.resize(size * size);
  right_.resize(size);
  bool symmetric = true;
  for (std::size_t r = 0; r < size; ++r) {
    const double* a = &a_[free_rows_[r] * rows()];
    double* row = &matrix_[r * size];
    for (std::size_t c = 0; c < size; ++c) row[c] = a[free_rows_[c]];
    double right = b_[free_rows_[r]];
    for (const std::size_t j : bounded_rows_) {
      if (places_[j].at == At::fixed) right -= a[j] * places_[j].value;
      if (places_[j].at != At::sliding) continue;
      const int normal = places_[bounds_[j].normal].free_index;
      row[normal] += a[j] * places_[j].value;
      symmetric = false;
    }
    right_[r] = right;
  }
  if (symmetric ? !solve_symmetric(size) : !solve_general(size)) return false;
  for (std::size_t i = 0; i < rows(); ++i) {
    const Place& place = places_[i];
    if (place.at == At::inside) x_[i] = right_[place.free_index];
    if (place.at == At::fixed) x_[i] = place.value;
    if (place.at == At::sliding) x_[i] = place.value * x_[bounds_[i].normal];
  }
  for (std::size_t i = 0; i < rows(); ++i) x_[i] = projected(i, x_[i]);
  return true;
}

/// Cholesky's method in place, R' R with reciprocals on R's diagonal. Each row is subtracted from the lines of those
/// below it, whose elements are independent: no sum waits for the one before.
bool BoundedProblem::solve_symmetric(std::size_t size) {
  diagonal_.resize(size);
  for (std::size_t i = 0; i < size; ++i) diagonal_[i] = matrix_[i * size + i];
  for (std::size_t i = 0; i < size; ++i) {
    double* row = &matrix_[i * size];
    if (!(row[i] > smallest_pivot * diagonal_[i])) return false;
    const double reciprocal = row[i] = 1.0 / std::sqrt(row[i]);
    for (std::size_t k = i + 1; k < size; ++k) row[k] *= reciprocal;
    for (std::size_t j = i + 1; j < size; ++j) {
      double* below = &matrix_[j * size];
      const double factor = row[j];
      for (std::size_t k = j; k < size; ++k) below[k] -= factor * row[k];
    }
  }
  for (std::size_t i = 0; i < size; ++i) {
    const double* row = &matrix_[i * size];
    const double value = right_[i] *= row[i];
    for (std::size_t k = i + 1; k < size; ++k) right_[k] -= row[k] * value;
  }
  for (std::size_t i = size; i-- > 0;) {
    const double* row = &matrix_[i * size];
    double sum = right_[i];
    for (std::size_t k = i + 1; k < size; ++k) sum -= row[k] * right_[k];
    right_[i] = sum * row[i];
  }
  return true;
}

/// Gauss's method with the largest pivot of each column, in place.
bool BoundedProblem::solve_general(std::size_t size) {
  const auto at = [&](std::size_t row, std::size_t column) -> double& { return matrix_[row * size + column]; };
  for (std::size_t c = 0; c < size; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < size; ++r)
      if (std::abs(at(r, c)) > std::abs(at(pivot, c))) pivot = r;
    if (!(std::abs(at(pivot, c)) > std::numeric_limits<double>::min())) return false;
    if (pivot != c) {
      std::swap_ranges(&at(pivot, 0), &at(pivot, 0) + size, &at(c, 0));
      std::swap(right_[pivot], right_[c]);
    }
    for (std::size_t r = c + 1; r < size; ++r) {
      const double factor = at(r, c) / at(c, c);
      if (factor == 0.0) continue;
      for (std::size_t k = c + 1; k < size; ++k) at(r, k) -= factor * at(c, k);
      right_[r] -= factor * right_[c];
    }
  }
  for (std::size_t r = size; r-- > 0;) {
    for (std::size_t k = r + 1; k < size; ++k) right_[r] -= at(r, k) * right_[k];
    right_[r] /= at(r, r);
  }
  return true;
}

/// Twice the decrease of x' A x / 2 - b' x since from_, with its slacks_. From the differences: the values themselves
/// are too large to show a small decrease.
double BoundedProblem::decrease() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows(); ++i)
    if (x_[i] != from_[i]) sum += (x_[i] - from_[i]) * (slacks_[i] + slack(i));
  return sum;
}

double BoundedProblem::clamped(std::size_t row, double value) const {
  return std::min(std::max(value, low_[row]), high_[row]);
}

/// Solves the problem with the constant bounds low_ and high_ by Newton steps along the free rows, projected onto the
/// bounds and shortened until the energy falls (D. Bertsekas, Projected Newton Methods for Optimization Problems with
/// Simple Constraints, SIAM J. Control and Optimization 20, 1982). Where none falls, a sweep does.
void BoundedProblem::solve_box(double tolerance, Outcome& outcome) {
  for (std::size_t i = 0; i < rows(); ++i) x_[i] = clamped(i, x_[i]);
  slacks_.resize(rows());
  for (int step = 0; step < most_box_steps; ++step) {
    double worst = 0.0;
    free_rows_.clear();
    for (std::size_t i = 0; i < rows(); ++i) {
      slacks_[i] = slack(i);
      worst = std::max(worst, std::abs(clamped(i, x_[i] + slacks_[i] / a_[i * rows() + i]) - x_[i]));
      const bool held = (x_[i] <= low_[i] && slacks_[i] <= 0.0) || (x_[i] >= high_[i] && slacks_[i] >= 0.0);
      if (!held) free_rows_.push_back(i);
    }
    if (!(worst > tolerance)) return;
    ++outcome.newton_steps;
    from_ = x_;
    if (!step_along_free_rows()) {
      x_ = from_;
      for (std::size_t i = 0; i < rows(); ++i) x_[i] = clamped(i, x_[i] + slack(i) / a_[i * rows() + i]);
      if (!(decrease() > 0.0)) return;  // rounding hides the rest
    }
  }
}

bool BoundedProblem::step_along_free_rows() {
  const std::size_t size = free_rows_.size();
  matrix_.resize(size * size);
  right_.resize(size);
  for (std::size_t r = 0; r < size; ++r) {
    right_[r] = slacks_[free_rows_[r]];
    for (std::size_t c = 0; c < size; ++c) matrix_[r * size + c] = a_[free_rows_[r] * rows() + free_rows_[c]];
  }
  if (!solve_symmetric(size)) return false;
  constexpr double shortest = 1e-4;
  for (double share = 1.0; share > shortest; share *= 0.5) {
    for (std::size_t r = 0; r < size; ++r)
      x_[free_rows_[r]] = clamped(free_rows_[r], from_[free_rows_[r]] + share * right_[r]);
    if (decrease() > 0.0) return true;
  }
  return false;
}

/// Friction's bounds are kept constant in each round, and follow the impulses of the normals between the rounds.
bool BoundedProblem::solve_in_rounds(double tolerance, int steps, Outcome& outcome) {
  constexpr double of_box = 0.01;  // share of the tolerance
  normals_ = x_;
  for (int round = 0; round < most_rounds && outcome.newton_steps < affordable(steps, rows()); ++round) {
    for (std::size_t i = 0; i < rows(); ++i) normals_[i] += share_of_round(round) * (x_[i] - normals_[i]);
    before_ = std::exchange(x_, normals_);
    low_.resize(rows());
    high_.resize(rows());
    for (std::size_t i = 0; i < rows(); ++i) {
      low_[i] = lower(i);
      high_[i] = upper(i);
    }
    x_ = before_;
    solve_box(of_box * tolerance, outcome);
    if (accept(tolerance, outcome)) return true;
    before_ = x_;
    for (int i = 0; i < polishing && newton_step(); ++i) {
      ++outcome.newton_steps;
      if (accept(tolerance, outcome)) return true;
    }
    x_ = before_;
  }
  return false;
}

/// Keeps the best approximation. Returns true if it is good enough.
bool BoundedProblem::accept(double tolerance, Outcome& outcome) {
  const double now = error();
  if (now < outcome.error) {
    outcome.error = now;
    best_ = x_;
  }
  return outcome.error <= tolerance;
}

BoundedProblem::Outcome BoundedProblem::solve(double tolerance, int steps) {
  Outcome outcome{infinite, 0};
  best_.clear();
  sweep();
  const std::vector<double>& start = start_ = x_;
  for (int i = 0; i < most_newton && newton_step(); ++i) {
    ++outcome.newton_steps;
    if (accept(tolerance, outcome)) return outcome;
  }
  x_ = start;
  solve_in_rounds(tolerance, steps, outcome);
  if (!best_.empty()) x_ = best_;
  return outcome;
}

}  // namespace rehearse
