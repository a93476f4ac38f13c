#include "bounded_problem.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace rehearse {
namespace {

constexpr int most_newton = 8;   // steps before the path
constexpr int polishing = 4;     // steps after it
constexpr int most_changes = 8;  // of the path, per row: 1.3 are usual, and 3 have been seen
constexpr int most_sweeps = 200;
constexpr double smallest_pivot = 1e-13;

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

/// The bound at which a row is; with a normal, a multiple of its impulse.
double BoundedProblem::bound(std::size_t row) const {
  return places_[row].at == At::upper ? bounds_[row].upper : bounds_[row].lower;
}

/// True for friction of a contact that separates.
bool BoundedProblem::has_no_contact(std::size_t row) const {
  const int normal = bounds_[row].normal;
  return normal >= 0 && places_[normal].at != At::inside;
}

/// The set of a Newton step: where a step along each row alone leads.
void BoundedProblem::classify() {
  places_.resize(rows());
  for (std::size_t i = 0; i < rows(); ++i) {
    const double wanted = x_[i] + slack(i) / a_[i * rows() + i];
    places_[i].at = wanted > upper(i) ? At::upper : wanted < lower(i) ? At::lower : At::inside;
  }
}

/// Factors the matrix of the rows that are inside their bounds, and sets right_ to what the others leave of b. Returns
/// false if the matrix is singular.
bool BoundedProblem::factor_inside_rows() {
  inside_rows_.clear();
  bounded_rows_.clear();
  for (std::size_t i = 0; i < rows(); ++i) {
    const bool is_inside = places_[i].at == At::inside && !has_no_contact(i);
    places_[i].free_index = is_inside ? static_cast<int>(inside_rows_.size()) : -1;
    if (is_inside)
      inside_rows_.push_back(i);
    else if (!has_no_contact(i))
      bounded_rows_.push_back(i);
  }
  const std::size_t size = inside_rows_.size();
  matrix_.resize(size * size);
  right_.resize(size);
  is_symmetric_ = true;
  for (std::size_t r = 0; r < size; ++r) {
    const double* a = &a_[inside_rows_[r] * rows()];
    double* row = &matrix_[r * size];
    for (std::size_t c = 0; c < size; ++c) row[c] = a[inside_rows_[c]];
    double right = b_[inside_rows_[r]];
    for (const std::size_t j : bounded_rows_) {
      if (bounds_[j].normal < 0) {
        right -= a[j] * bound(j);
      } else {
        row[places_[bounds_[j].normal].free_index] += a[j] * bound(j);
        is_symmetric_ = false;
      }
    }
    right_[r] = right;
  }
  return is_symmetric_ ? factor_symmetric(size) : factor_general(size);
}

/// Solves the rows that are inside their bounds; the others are at bounds. Returns false if the matrix is singular.
bool BoundedProblem::newton_step() {
  classify();
  if (!factor_inside_rows()) return false;
  substitute(right_);
  std::ranges::fill(x_, 0.0);
  for (std::size_t r = 0; r < inside_rows_.size(); ++r) x_[inside_rows_[r]] = right_[r];
  for (const std::size_t i : bounded_rows_) x_[i] = bounds_[i].normal < 0 ? bound(i) : bound(i) * x_[bounds_[i].normal];
  for (std::size_t i = 0; i < rows(); ++i) x_[i] = projected(i, x_[i]);
  return true;
}

/// Cholesky's method in place, R' R with reciprocals on R's diagonal. Each row is subtracted from the lines of those
/// below it, whose elements are independent: no sum waits for the one before.
bool BoundedProblem::factor_symmetric(std::size_t size) {
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
  return true;
}

/// Gauss's method with the largest pivot of each column, in place: L without its diagonal, and R.
bool BoundedProblem::factor_general(std::size_t size) {
  const auto at = [&](std::size_t row, std::size_t column) -> double& { return matrix_[row * size + column]; };
  pivots_.resize(size);
  for (std::size_t c = 0; c < size; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c + 1; r < size; ++r)
      if (std::abs(at(r, c)) > std::abs(at(pivot, c))) pivot = r;
    if (!(std::abs(at(pivot, c)) > std::numeric_limits<double>::min())) return false;
    pivots_[c] = pivot;
    if (pivot != c) std::swap_ranges(&at(pivot, 0), &at(pivot, 0) + size, &at(c, 0));
    for (std::size_t r = c + 1; r < size; ++r) {
      const double factor = at(r, c) /= at(c, c);
      if (factor == 0.0) continue;
      for (std::size_t k = c + 1; k < size; ++k) at(r, k) -= factor * at(c, k);
    }
  }
  return true;
}

/// Solves with the factors of factor_inside_rows(), in place.
void BoundedProblem::substitute(std::vector<double>& right) const {
  const std::size_t size = inside_rows_.size();
  if (is_symmetric_) {
    for (std::size_t i = 0; i < size; ++i) {
      const double* row = &matrix_[i * size];
      const double value = right[i] *= row[i];
      for (std::size_t k = i + 1; k < size; ++k) right[k] -= row[k] * value;
    }
    for (std::size_t i = size; i-- > 0;) {
      const double* row = &matrix_[i * size];
      double sum = right[i];
      for (std::size_t k = i + 1; k < size; ++k) sum -= row[k] * right[k];
      right[i] = sum * row[i];
    }
    return;
  }
  for (std::size_t c = 0; c < size; ++c) std::swap(right[pivots_[c]], right[c]);
  for (std::size_t r = 0; r < size; ++r)
    for (std::size_t c = 0; c < r; ++c) right[r] -= matrix_[r * size + c] * right[c];
  for (std::size_t r = size; r-- > 0;) {
    for (std::size_t k = r + 1; k < size; ++k) right[r] -= matrix_[r * size + k] * right[k];
    right[r] /= matrix_[r * size + r];
  }
}

/// All rows that have a bound are at it, as for a large t. The shares of the golden ratio let no two rows change at the
/// same t.
void BoundedProblem::begin_path() {
  constexpr double golden = 0.6180339887498949;
  push_.resize(rows());
  for (std::size_t i = 0; i < rows(); ++i) {
    const bool has_lower = std::isfinite(bounds_[i].lower), has_upper = std::isfinite(bounds_[i].upper);
    places_[i].at = has_lower ? At::lower : has_upper ? At::upper : At::inside;
    const double share = golden * static_cast<double>(i + 1);
    const double size = std::sqrt(a_[i * rows() + i]) * (1.0 + share - std::floor(share));
    push_[i] = has_lower ? size : has_upper ? -size : 0.0;
  }
}

/// Impulses and slacks as functions of t, with each row in its place. Returns false if the matrix is singular.
bool BoundedProblem::solve_along_path() {
  if (!factor_inside_rows()) return false;
  substitute(right_);
  right_slopes_.resize(inside_rows_.size());
  for (std::size_t r = 0; r < inside_rows_.size(); ++r) right_slopes_[r] = -push_[inside_rows_[r]];
  substitute(right_slopes_);
  impulses_.assign(rows(), {});
  for (std::size_t r = 0; r < inside_rows_.size(); ++r) impulses_[inside_rows_[r]] = {right_[r], right_slopes_[r]};
  for (const std::size_t i : bounded_rows_) {
    const Linear of = bounds_[i].normal < 0 ? Linear{1.0, 0.0} : impulses_[bounds_[i].normal];
    impulses_[i] = {bound(i) * of.value, bound(i) * of.slope};
  }
  slacks_.resize(rows());
  for (std::size_t i = 0; i < rows(); ++i) {
    Linear slack{b_[i], -push_[i]};
    for (std::size_t j = 0; j < rows(); ++j) {
      slack.value -= a_[i * rows() + j] * impulses_[j].value;
      slack.slope -= a_[i * rows() + j] * impulses_[j].slope;
    }
    slacks_[i] = slack;
  }
  return true;
}

/// The distance of a row from the change; it is negative beyond it.
BoundedProblem::Linear BoundedProblem::gap(Change change) const {
  const auto [row, to] = change;
  if (to == At::inside) {
    const double sign = places_[row].at == At::upper ? 1.0 : -1.0;
    return {sign * slacks_[row].value, sign * slacks_[row].slope};
  }
  const double sign = to == At::upper ? -1.0 : 1.0, bound = to == At::upper ? bounds_[row].upper : bounds_[row].lower;
  const Linear of = bounds_[row].normal < 0 ? Linear{1.0, 0.0} : impulses_[bounds_[row].normal];
  return {sign * (impulses_[row].value - bound * of.value), sign * (impulses_[row].slope - bound * of.slope)};
}

template <typename Visit>
void BoundedProblem::visit_changes(Visit&& visit) const {
  for (std::size_t i = 0; i < rows(); ++i) {
    if (has_no_contact(i)) continue;
    if (places_[i].at != At::inside) visit(Change{i, At::inside});
    if (places_[i].at != At::inside) continue;
    if (std::isfinite(bounds_[i].lower)) visit(Change{i, At::lower});
    if (std::isfinite(bounds_[i].upper)) visit(Change{i, At::upper});
  }
}

/// A contact that begins slides at first: its limit of friction is zero.
void BoundedProblem::make(Change change, double t) {
  places_[change.row].at = change.to;
  if (change.to != At::inside) return;
  for (std::size_t i = change.row + 1; i < rows(); ++i)
    if (bounds_[i].normal == static_cast<int>(change.row) && std::isfinite(bounds_[i].lower))
      places_[i].at = slacks_[i](t) > 0.0 ? At::upper : At::lower;
}

/// Follows the path to t = 0. Returns false if it doesn't end there within the changes that rows may have.
bool BoundedProblem::follow_path(Outcome& outcome) {
  begin_path();
  double t = infinite, direction = -1.0;
  std::optional<Change> back;  // from the last one
  for (std::size_t changes = 0; changes < most_changes * rows(); ++changes) {
    if (!solve_along_path()) return false;
    ++outcome.steps;
    if (back) direction = gap(*back).slope > 0.0 ? 1.0 : -1.0;
    std::optional<Change> next;
    double at = direction < 0.0 ? 0.0 : infinite;  // the t of the next one
    visit_changes([&](Change change) {
      const Linear distance = gap(change);
      if (!(distance.slope * direction < 0.0)) return;
      const double zero = -distance.value / distance.slope;
      if (direction < 0.0 ? !(zero > at) : !(zero < at)) return;
      at = zero;
      next = change;
    });
    if (!next && direction > 0.0) return false;
    if (!next) {
      for (std::size_t i = 0; i < rows(); ++i) x_[i] = impulses_[i].value;
      for (std::size_t i = 0; i < rows(); ++i) x_[i] = projected(i, x_[i]);
      return true;
    }
    t = direction < 0.0 ? std::min(t, at) : std::max(t, at);
    back = Change{next->row, places_[next->row].at};
    make(*next, t);
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

BoundedProblem::Outcome BoundedProblem::solve(double tolerance) {
  Outcome outcome{infinite, 0};
  best_.clear();
  const auto newton = [&](int most) {
    for (int i = 0; i < most && newton_step(); ++i) {
      ++outcome.steps;
      if (accept(tolerance, outcome)) return true;
    }
    return false;
  };
  sweep();
  if (newton(most_newton)) return outcome;
  if (follow_path(outcome) && (accept(tolerance, outcome) || newton(polishing))) return outcome;
  if (!best_.empty()) x_ = best_;
  for (int i = 0; i < most_sweeps && !accept(tolerance, outcome); ++i) sweep();
  if (!best_.empty()) x_ = best_;
  return outcome;
}

}  // namespace rehearse
