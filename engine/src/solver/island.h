// Island: bodies that constraints connect, and a step of them. Private to the engine.
//
// Joints are equations of the forest. Everything with bounds is a row of the island: contacts with friction, stops of
// joints, and connections beyond the trees. A drive with a limited effort is an equation while its effort is inside
// the limit, and a known effort while it is at the limit. Which of both it is, is assumed from the last step and
// checked; a wrong assumption makes it a bounded row, and the step is solved again.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "bounded_problem.h"
#include "forest.h"

namespace rehearse {

/// The drive or the dry friction of a joint: a row with a limited impulse between a body and its parent.
struct LimitedDrive {
  enum class State { holds, at_lower, at_upper, bounded };
  int body = 0;
  Row row;
  double limit = 0.0;          // of the impulse's magnitude
  State state = State::holds;  // before the step as assumed, after it as it was
  double impulse = 0.0;        // of the step
};

/// A constraint with bounds.
struct BoundedRow {
  int body = 0;
  int other = -1;  // -1: the world
  Row row;
  BoundedProblem::Bounds bounds;
  double impulse = 0.0;  // before the step an estimate
};

class Island {
 public:
  explicit Island(Forest& forest) : forest_(forest) {}

  void clear();
  /// The bodies from `first` to the one before `last`: whole trees.
  void add_trees(int first, int last);
  void add_drive(const LimitedDrive& drive) { drives_.push_back(drive); }
  /// Returns the row's index, for the bounds of friction.
  int add_row(const BoundedRow& row);

  const std::vector<LimitedDrive>& drives() const { return drives_; }
  const std::vector<BoundedRow>& rows() const { return rows_; }

  /// Solves the step; the forest then has the velocities. `tolerance`: of impulses [N·s].
  BoundedProblem::Outcome solve(double tolerance);

 private:
  /// Where a row acts: on a column of its own, or on six columns of each of its bodies.
  struct Action {
    int first = 0;    // column
    int second = -1;  // -1: none
    bool single = false;
  };
  struct Units {
    int body;
    int column;  // the first of six
  };

  void assume_drives();
  BoundedProblem::Outcome solve_once(double tolerance);
  bool check_drives();
  int unit_columns(int body);
  void add_actions();
  void set_products();
  void set_problem();
  double velocity_of(const BoundedRow& row) const;
  double velocity_of(const LimitedDrive& drive) const;
  void apply(int body, const Vector6d& direction, double impulse);
  void push(int body, const Vector6d& direction, double impulse);

  Forest& forest_;
  std::vector<std::pair<int, int>> trees_;
  std::vector<LimitedDrive> drives_;
  std::vector<BoundedRow> rows_;
  // scratch
  std::vector<std::size_t> joint_sizes_;  // without drives, by body of the trees
  std::vector<Vector6d> momenta_;         // without impulses of rows, likewise
  std::vector<BoundedRow> all_;           // rows_, then the bounded drives
  std::vector<std::size_t> bounded_drives_;
  std::vector<Action> actions_;
  std::vector<Units> units_;
  std::vector<std::pair<int, Vector6d>> pushes_;  // by body
  std::vector<int> group_columns_;                // by group of columns of the forest: the first
  std::vector<double> products_, half_;
  int columns_ = 0;
  BoundedProblem problem_;
};

}  // namespace rehearse
