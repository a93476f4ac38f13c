#include "island.h"

#include <algorithm>
#include <cmath>

namespace rehearse {

void Island::clear() {
  trees_.clear();
  drives_.clear();
  stops_.clear();
  rows_.clear();
  joint_rows_.clear();
  moves_.clear();
}

/// Sets the drives of joints to what their states imply.
void Island::assume_drives() {
  for (LimitedDrive& drive : drives_) {
    TreeBody& body = forest_.bodies()[drive.body];
    body.drive.reset();
    body.push = 0.0;
    switch (drive.state) {
      case LimitedDrive::State::holds: body.drive = drive.drive; break;
      case LimitedDrive::State::at_upper: body.push = drive.impulse = drive.limit; break;
      case LimitedDrive::State::at_lower: body.push = drive.impulse = -drive.limit; break;
      case LimitedDrive::State::bounded: break;
    }
  }
}

/// Returns false if a drive isn't in the state that was assumed.
bool Island::check_drives() {
  constexpr double ample = 1e-12;  // rounding, as a share
  bool right = true;
  for (LimitedDrive& drive : drives_) {
    if (drive.state == LimitedDrive::State::bounded) continue;
    if (drive.state == LimitedDrive::State::holds) {
      drive.impulse = forest_.drive_impulse(drive.body);
      if (std::abs(drive.impulse) <= drive.limit * (1.0 + ample)) continue;
      forest_.change_drive(drive.body);
    } else {
      const double missing = drive.drive.target - forest_.rate(drive.body) - drive.drive.softness * drive.impulse;
      if (drive.state == LimitedDrive::State::at_upper ? missing >= 0.0 : missing <= 0.0) continue;
    }
    drive.state = LimitedDrive::State::bounded;
    right = false;
  }
  return right;
}

/// Returns false if a joint leaves the range of its stops. A drive that holds has a target between them.
bool Island::check_stops() {
  constexpr double ample = 1e-9;   // [rad/s] or [m/s]
  constexpr int most_changes = 3;  // of one stop in a step
  bool right = true;
  for (Stop& stop : stops_) {
    if (stop.state == Stop::State::locked || stop.impulse != 0.0 || stop.changes == most_changes) continue;
    if (forest_.bodies()[stop.body].drive) continue;
    const double rate = forest_.rate(stop.body);
    const auto wanted = rate > stop.highest + ample  ? Stop::State::at_upper
                        : rate < stop.lowest - ample ? Stop::State::at_lower
                                                     : stop.state;
    if (wanted == stop.state) continue;
    stop.state = wanted;
    ++stop.changes;
    right = false;
  }
  return right;
}

const Island::Columns& Island::columns_of(int body, bool of_joint) {
  for (const Columns& columns : columns_)
    if (columns.body == body && columns.of_joint == of_joint) return columns;
  const int group = of_joint ? forest_.add_joint_column(body) : forest_.add_body_columns(body);
  columns_.push_back({body, of_joint, group, column_count_});
  column_count_ += of_joint ? 1 : 6;
  return columns_.back();
}

/// Returns the velocity along the direction.
double Island::add_terms(int body, const Vector6d& direction) {
  if (body < 0) return 0.0;
  const int first = columns_of(body, false).first;
  for (int i = 0; i < 6; ++i)
    if (direction[i] != 0.0) terms_.push_back({first + i, direction[i]});
  return dot6(direction, forest_.velocity(body));
}

double Island::add_terms(int joint, double factor) {
  if (joint < 0) return 0.0;
  terms_.push_back({columns_of(joint, true).first, factor});
  return factor * forest_.rate(joint);
}

/// Of the terms that were added since the last one.
void Island::add_constraint(double velocity, double target, double softness, const BoundedProblem::Bounds& bounds,
                            double& impulse) {
  const std::size_t begin = constraints_.empty() ? 0 : constraints_.back().end;
  constraints_.push_back({begin, terms_.size(), velocity, target, softness, bounds, &impulse});
}

/// Rows of bodies come first: bounds of friction refer to their indices.
void Island::add_constraints() {
  forest_.clear_columns();
  column_count_ = 0;
  columns_.clear();
  terms_.clear();
  constraints_.clear();
  for (BoundedRow& row : rows_) {
    const double of_body = add_terms(row.body, row.row.first);
    add_constraint(of_body + add_terms(row.other, row.row.second), row.row.target, row.row.softness, row.bounds,
                   row.impulse);
  }
  for (JointRow& row : joint_rows_) {
    const double of_body = add_terms(row.body, 1.0);
    add_constraint(of_body + add_terms(row.other, row.factor), row.target, row.softness, row.bounds, row.impulse);
  }
  for (Stop& stop : stops_) {
    if (stop.state == Stop::State::free) continue;
    BoundedProblem::Bounds bounds;
    if (stop.state == Stop::State::at_lower) bounds.lower = 0.0;
    if (stop.state == Stop::State::at_upper) bounds.upper = 0.0;
    const double target = stop.state == Stop::State::at_lower ? stop.lowest : stop.highest;
    add_constraint(add_terms(stop.body, 1.0), target, stop.softness, bounds, stop.impulse);
  }
  for (LimitedDrive& drive : drives_) {
    if (drive.state != LimitedDrive::State::bounded) continue;
    add_constraint(add_terms(drive.body, 1.0), drive.drive.target, drive.drive.softness,
                   {-drive.limit, drive.limit, -1}, drive.impulse);
  }
}

void Island::set_products() {
  const auto count = static_cast<std::size_t>(column_count_);
  products_.resize(count * count);
  for (const Columns& one : columns_) {
    const auto row = static_cast<std::size_t>(one.first);
    for (const Columns& other : columns_) {
      const auto column = static_cast<std::size_t>(other.first);
      forest_.multiply(one.group, other.group, &products_[row * count + column], count);
      if (&one == &other) break;
      for (int r = 0; r < forest_.width(one.group); ++r)
        for (int c = 0; c < forest_.width(other.group); ++c)
          products_[(column + c) * count + row + r] = products_[(row + r) * count + column + c];
    }
  }
}

/// A = J V J', with the velocities V that unit impulses along the columns cause.
void Island::set_problem() {
  const auto count = static_cast<std::size_t>(column_count_);
  problem_.reset(constraints_.size());
  half_.resize(count);
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const Constraint& row = constraints_[i];
    std::ranges::fill(half_, 0.0);
    for (std::size_t t = row.begin; t < row.end; ++t) {
      const double* line = &products_[static_cast<std::size_t>(terms_[t].column) * count];
      const double factor = terms_[t].factor;
      for (std::size_t c = 0; c < count; ++c) half_[c] += factor * line[c];
    }
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (std::size_t t = constraints_[j].begin; t < constraints_[j].end; ++t)
        sum += half_[static_cast<std::size_t>(terms_[t].column)] * terms_[t].factor;
      problem_.a(i, j) = problem_.a(j, i) = sum;
    }
    problem_.a(i, i) += row.softness;
    problem_.b(i) = row.target - row.velocity;
    problem_.bounds(i) = row.bounds;
    problem_.x(i) = *row.impulse;
  }
}

/// Gives the impulses of the rows to the forest.
void Island::push() {
  pushes_.assign(static_cast<std::size_t>(column_count_), 0.0);
  for (std::size_t i = 0; i < constraints_.size(); ++i) {
    const double impulse = *constraints_[i].impulse = problem_.x(i);
    for (std::size_t t = constraints_[i].begin; t < constraints_[i].end; ++t)
      pushes_[static_cast<std::size_t>(terms_[t].column)] += terms_[t].factor * impulse;
  }
  for (const Columns& columns : columns_) {
    const double* of = &pushes_[static_cast<std::size_t>(columns.first)];
    if (columns.of_joint)
      forest_.push_joint(columns.body, *of);
    else
      forest_.push(columns.body, Eigen::Map<const Vector6d>(of));
  }
}

BoundedProblem::Outcome Island::solve_once(double tolerance) {
  for (const auto& [first, last] : trees_) forest_.solve(first, last);
  add_constraints();
  if (constraints_.empty()) return {0.0, 0};
  set_products();
  set_problem();
  const BoundedProblem::Outcome outcome = problem_.solve(tolerance);
  push();
  for (const auto& [first, last] : trees_) forest_.descend(first, last);
  return outcome;
}

/// Each repetition has one more row.
BoundedProblem::Outcome Island::settle(double tolerance) {
  for (;;) {
    const BoundedProblem::Outcome outcome = solve_once(tolerance);
    const bool right = check_drives();
    if (check_stops() && right) return outcome;
    assume_drives();
    for (const auto& [first, last] : trees_) forest_.refactor(first, last);
  }
}

/// The rates that move joints back to their stops are for the step's motion only.
void Island::withdraw_corrections() {
  for (const auto& [first, last] : trees_)
    for (int body = first; body < last; ++body) moves_.emplace_back(body, forest_.velocity(body));
  for (Stop& stop : stops_) {
    if (!stop.corrects) continue;
    stop.lowest = std::min(stop.lowest, 0.0);
    stop.highest = std::max(stop.highest, 0.0);
    if (stop.state == Stop::State::locked) stop.lowest = stop.highest = 0.0;
  }
}

BoundedProblem::Outcome Island::solve(double tolerance) {
  assume_drives();
  for (const auto& [first, last] : trees_) forest_.factor(first, last);
  const BoundedProblem::Outcome outcome = settle(tolerance);
  if (std::ranges::none_of(stops_, [](const Stop& stop) { return stop.corrects && stop.impulse != 0.0; }))
    return outcome;
  withdraw_corrections();
  const BoundedProblem::Outcome second = settle(tolerance);
  return {std::max(outcome.error, second.error), outcome.steps + second.steps};
}

const Vector6d& Island::moving_velocity(int body) const {
  const auto found = std::ranges::find(moves_, body, [](const auto& move) { return move.first; });
  return found == moves_.end() ? forest_.velocity(body) : found->second;
}

}  // namespace rehearse
