// Island: bodies that constraints connect, and a step of them. Private to the engine.
//
// Joints are coordinates of the forest. Everything with bounds is a row of the island: contacts with friction, joints
// that follow others, and connections beyond the trees. A drive with a limited effort is part of its joint while its
// effort is inside the limit, and a known effort while it is at the limit. A stop is a row while it is touched. What
// drives and stops do is assumed from the last step and checked; a wrong assumption makes a row, and the step is solved
// again.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "bounded_problem.h"
#include "forest.h"

namespace rehearse {

/// The drive or the dry friction of a joint: its impulse is limited.
struct LimitedDrive {
  enum class State { holds, at_lower, at_upper, bounded };
  int body = 0;
  HeldDrive drive;
  double limit = 0.0;          // of the impulse's magnitude
  State state = State::holds;  // before the step as assumed, after it as it was
  double impulse = 0.0;        // of the step
};

/// The stops of a joint: the rates between which it may move in the step.
struct Stop {
  enum class State { free, at_lower, at_upper, locked };
  int body = 0;
  double lowest = 0.0, highest = 0.0;  // where they are equal, the state is `locked`
  double softness = 0.0;
  bool corrects = false;      // the joint is beyond its stop: the rate moves it back, and isn't kept after the step
  State state = State::free;  // before the step as assumed, after it as it was
  double impulse = 0.0;       // of the step
  int changes = 0;            // of the state, while the step is solved
};

/// A constraint with bounds on the velocities of bodies.
struct BoundedRow {
  int body = 0;
  int other = -1;  // -1: the world
  Row row;
  BoundedProblem::Bounds bounds;
  double impulse = 0.0;  // before the step an estimate
};

/// A constraint with bounds on the rates of two joints: rate + factor * other rate = target. Its impulse x acts on the
/// first coordinate, and factor x on the other.
struct JointRow {
  int body = 0;
  int other = -1;  // -1: none
  double factor = 0.0;
  double target = 0.0;
  double softness = 0.0;
  BoundedProblem::Bounds bounds;
  double impulse = 0.0;  // before the step an estimate
};

class Island {
 public:
  explicit Island(Forest& forest) : forest_(forest) {}

  void clear();
  /// The bodies from `first` to the one before `last`: whole trees.
  void add_trees(int first, int last) { trees_.emplace_back(first, last); }
  /// These return the index in their list.
  int add_drive(const LimitedDrive& drive) { return add(drive, drives_); }
  int add_stop(const Stop& stop) { return add(stop, stops_); }
  int add_row(const BoundedRow& row) { return add(row, rows_); }
  int add_row(const JointRow& row) { return add(row, joint_rows_); }

  const std::vector<LimitedDrive>& drives() const { return drives_; }
  const std::vector<Stop>& stops() const { return stops_; }
  const std::vector<BoundedRow>& rows() const { return rows_; }
  const std::vector<JointRow>& joint_rows() const { return joint_rows_; }

  /// Solves the step; the forest then has the velocities. `tolerance`: of impulses [N·s].
  BoundedProblem::Outcome solve(double tolerance);
  /// The velocity by which a body moves in the step: that of the forest, or one that also corrects positions.
  const Vector6d& moving_velocity(int body) const;

 private:
  template <class Item>
  static int add(const Item& item, std::vector<Item>& list) {
    list.push_back(item);
    return static_cast<int>(list.size()) - 1;
  }

  /// A row of the bounded problem: a sum of velocities of columns.
  struct Term {
    int column;
    double factor;
  };
  struct Constraint {
    std::size_t begin, end;  // of its terms
    double velocity;         // without impulses of rows
    double target, softness;
    BoundedProblem::Bounds bounds;
    double* impulse;
  };
  struct Columns {
    int body;
    bool of_joint;
    int group;
    int first;
  };

  void assume_drives();
  bool check_drives();
  bool check_stops();
  void withdraw_corrections();
  BoundedProblem::Outcome settle(double tolerance);
  BoundedProblem::Outcome solve_once(double tolerance);
  void add_constraints();
  void add_constraint(double velocity, double target, double softness, const BoundedProblem::Bounds& bounds,
                      double& impulse);
  double add_terms(int body, const Vector6d& direction);
  double add_terms(int joint, double factor);
  const Columns& columns_of(int body, bool of_joint);
  void set_products();
  void set_problem();
  void push();

  Forest& forest_;
  std::vector<std::pair<int, int>> trees_;
  std::vector<LimitedDrive> drives_;
  std::vector<Stop> stops_;
  std::vector<BoundedRow> rows_;
  std::vector<JointRow> joint_rows_;
  std::vector<std::pair<int, Vector6d>> moves_;  // by body of the trees; empty: those of the forest
  // scratch
  std::vector<Constraint> constraints_;
  std::vector<Term> terms_;
  std::vector<Columns> columns_;
  int column_count_ = 0;
  std::vector<double> products_, half_, pushes_;  // the last by column
  BoundedProblem problem_;
};

}  // namespace rehearse
