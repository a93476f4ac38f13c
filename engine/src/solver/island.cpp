#include "island.h"

#include <algorithm>
#include <cmath>

namespace rehearse {

void Island::clear() {
  trees_.clear();
  drives_.clear();
  rows_.clear();
  joint_sizes_.clear();
  momenta_.clear();
}

void Island::add_trees(int first, int last) {
  trees_.emplace_back(first, last);
  for (int body = first; body < last; ++body) {
    joint_sizes_.push_back(forest_.bodies()[body].joint.size());
    momenta_.push_back(forest_.bodies()[body].momentum);
  }
}

int Island::add_row(const BoundedRow& row) {
  rows_.push_back(row);
  return static_cast<int>(rows_.size()) - 1;
}

void Island::apply(int body, const Vector6d& direction, double impulse) {
  if (body >= 0) forest_.bodies()[body].momentum += direction * impulse;
}

double Island::velocity_of(const BoundedRow& row) const {
  const double of_body = dot6(row.row.first, forest_.velocity(row.body));
  return row.other < 0 ? of_body : of_body + dot6(row.row.second, forest_.velocity(row.other));
}

double Island::velocity_of(const LimitedDrive& drive) const {
  const double of_body = dot6(drive.row.first, forest_.velocity(drive.body));
  const int parent = forest_.bodies()[drive.body].parent;
  return parent < 0 ? of_body : of_body + dot6(drive.row.second, forest_.velocity(parent));
}

/// Sets joints and momenta to those that the states of the drives imply.
void Island::assume_drives() {
  std::size_t place = 0;
  for (const auto& [first, last] : trees_) {
    for (int body = first; body < last; ++body, ++place) {
      forest_.bodies()[body].joint.truncate(joint_sizes_[place]);
      forest_.bodies()[body].momentum = momenta_[place];
    }
  }
  bounded_drives_.clear();
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    LimitedDrive& drive = drives_[i];
    TreeBody& body = forest_.bodies()[drive.body];
    if (drive.state == LimitedDrive::State::holds) body.joint.add() = drive.row;
    if (drive.state == LimitedDrive::State::bounded) bounded_drives_.push_back(i);
    if (drive.state != LimitedDrive::State::at_lower && drive.state != LimitedDrive::State::at_upper) continue;
    drive.impulse = drive.state == LimitedDrive::State::at_upper ? drive.limit : -drive.limit;
    apply(drive.body, drive.row.first, drive.impulse);
    apply(body.parent, drive.row.second, drive.impulse);
  }
}

/// Returns false if a drive isn't in the state that was assumed.
bool Island::check_drives() {
  constexpr double ample = 1e-12;  // rounding, as a share
  bool right = true;
  for (LimitedDrive& drive : drives_) {
    if (drive.state == LimitedDrive::State::bounded) continue;
    if (drive.state == LimitedDrive::State::holds) {
      const std::size_t row = forest_.bodies()[drive.body].joint.size() - 1;  // the drive's is the last
      drive.impulse = forest_.impulses(drive.body)[row];
      if (std::abs(drive.impulse) <= drive.limit * (1.0 + ample)) continue;
    } else {
      const double missing = drive.row.target - velocity_of(drive) - drive.row.softness * drive.impulse;
      if (drive.state == LimitedDrive::State::at_upper ? missing >= 0.0 : missing <= 0.0) continue;
    }
    if (drive.state == LimitedDrive::State::holds) forest_.change_joint(drive.body);
    drive.state = LimitedDrive::State::bounded;
    right = false;
  }
  return right;
}

int Island::unit_columns(int body) {
  for (const Units& units : units_)
    if (units.body == body) return units.column;
  forest_.add_unit_columns(body);
  group_columns_.push_back(columns_);
  units_.push_back({body, columns_});
  columns_ += 6;
  return units_.back().column;
}

void Island::add_actions() {
  forest_.clear_columns();
  columns_ = 0;
  units_.clear();
  group_columns_.clear();
  actions_.clear();
  all_ = rows_;
  for (const std::size_t i : bounded_drives_) {
    const LimitedDrive& drive = drives_[i];
    all_.push_back(
        {drive.body, forest_.bodies()[drive.body].parent, drive.row, {-drive.limit, drive.limit, -1}, drive.impulse});
  }
  for (const BoundedRow& row : all_) {
    Action& action = actions_.emplace_back();
    action.single = row.other >= 0 && forest_.bodies()[row.body].parent == row.other;
    if (action.single) {
      forest_.add_column(row.body, row.row.first, row.row.second);
      group_columns_.push_back(columns_);
      action.first = columns_++;
    } else {
      action.first = unit_columns(row.body);
      if (row.other >= 0) action.second = unit_columns(row.other);
    }
  }
}

void Island::set_products() {
  const auto count = static_cast<std::size_t>(columns_);
  products_.resize(count * count);
  const int groups = static_cast<int>(group_columns_.size());
  for (int i = 0; i < groups; ++i) {
    for (int j = 0; j <= i; ++j) {
      const auto row = static_cast<std::size_t>(group_columns_[i]),
                 column = static_cast<std::size_t>(group_columns_[j]);
      forest_.multiply(i, j, &products_[row * count + column], count);
      if (i == j) continue;
      for (int r = 0; r < forest_.width(i); ++r)
        for (int c = 0; c < forest_.width(j); ++c)
          products_[(column + c) * count + row + r] = products_[(row + r) * count + column + c];
    }
  }
}

/// A = J V J', with the velocities V that unit impulses along the columns cause.
void Island::set_problem() {
  const auto count = static_cast<std::size_t>(columns_);
  problem_.reset(all_.size());
  half_.resize(count);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const Row& row = all_[i].row;
    std::ranges::fill(half_, 0.0);
    const auto add_columns = [&](int first, const Vector6d& direction) {
      for (int k = 0; k < 6; ++k)
        for (std::size_t c = 0; c < count; ++c) half_[c] += direction[k] * products_[(first + k) * count + c];
    };
    if (actions_[i].single) {
      const double* products = &products_[static_cast<std::size_t>(actions_[i].first) * count];
      std::copy(products, products + count, half_.begin());
    } else {
      add_columns(actions_[i].first, row.first);
      if (actions_[i].second >= 0) add_columns(actions_[i].second, row.second);
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const Row& other = all_[j].row;
      double sum = 0.0;
      if (actions_[j].single) {
        sum = half_[actions_[j].first];
      } else {
        for (int k = 0; k < 6; ++k) sum += half_[actions_[j].first + k] * other.first[k];
        if (actions_[j].second >= 0)
          for (int k = 0; k < 6; ++k) sum += half_[actions_[j].second + k] * other.second[k];
      }
      problem_.a(i, j) = problem_.a(j, i) = sum;
    }
    problem_.a(i, i) += row.softness;
    problem_.b(i) = row.target - velocity_of(all_[i]);
    problem_.bounds(i) = all_[i].bounds;
    problem_.x(i) = all_[i].impulse;
  }
}

void Island::push(int body, const Vector6d& direction, double impulse) {
  if (body < 0 || impulse == 0.0) return;
  for (auto& [of, momentum] : pushes_) {
    if (of != body) continue;
    momentum += direction * impulse;
    return;
  }
  pushes_.emplace_back(body, direction * impulse);
}

BoundedProblem::Outcome Island::solve_once(double tolerance) {
  for (const auto& [first, last] : trees_) forest_.solve(first, last);
  add_actions();
  if (all_.empty()) return {0.0, 0};
  set_products();
  set_problem();
  const BoundedProblem::Outcome outcome = problem_.solve(tolerance);
  pushes_.clear();
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const double impulse = problem_.x(i);
    push(all_[i].body, all_[i].row.first, impulse);
    push(all_[i].other, all_[i].row.second, impulse);
    (i < rows_.size() ? rows_[i].impulse : drives_[bounded_drives_[i - rows_.size()]].impulse) = impulse;
  }
  for (const auto& [body, momentum] : pushes_) forest_.push(body, momentum);
  for (const auto& [first, last] : trees_) forest_.descend(first, last);
  return outcome;
}

BoundedProblem::Outcome Island::solve(double tolerance) {
  assume_drives();
  for (const auto& [first, last] : trees_) forest_.factor(first, last);
  for (;;) {  // each repetition has one more bounded drive
    const BoundedProblem::Outcome outcome = solve_once(tolerance);
    if (check_drives()) return outcome;
    assume_drives();
    for (const auto& [first, last] : trees_) forest_.refactor(first, last);
  }
}

}  // namespace rehearse
