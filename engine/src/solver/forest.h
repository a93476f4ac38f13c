// Forest: the velocities of trees of rigid bodies whose joints are equations. Private to the engine.
//
// With the masses M, the momentum g of the bodies after a step without constraints, and the rows J of the joints, the
// velocities v and impulses x of a step solve
//     M v - J' x = g
//     J v + E x = c
// D. Baraff, Linear-Time Dynamics using Lagrange Multipliers, SIGGRAPH 1996: ordered from the leaves to the roots of
// the trees, body before joint, the matrix is factored in blocks without fill-in. The time is linear in the number of
// bodies. The factor is L D L' with D = +1 for bodies and -1 for joints. Sums are in a fixed order, so that bits don't
// depend on compilers and processors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "rows.h"

namespace rehearse {

/// A rigid body and the joint that connects it to its parent or to the world. In the joint's rows this body is the
/// first, its parent the second.
struct TreeBody {
  int parent = -1;                                    // index of the parent, less than its own; -1: the world, or none
  double mass = 0.0;                                  // [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass, world axes [kg·m²]
  Vector6d momentum = Vector6d::Zero();  // after a step without constraints: linear [N·s], angular [N·m·s]
  JointRows joint;                       // equations: guides, unlimited drives, damping
};

class Forest {
 public:
  using Impulses = std::array<double, most_joint_rows>;

  std::vector<TreeBody>& bodies() { return bodies_; }
  const std::vector<TreeBody>& bodies() const { return bodies_; }

  /// Factors the matrix of the bodies from `first` to the one before `last`, which are whole trees. A changed joint
  /// needs a new factor; a changed momentum doesn't.
  void factor(int first, int last);
  /// The joint of a body changes after factor(), its masses don't: refactor() must follow.
  void change_joint(int body);
  /// Factors again what depends on changed joints: their bodies, and all from there to the root. Each bit is that of
  /// factor().
  void refactor(int first, int last);
  /// Computes velocities and impulses of these bodies.
  void solve(int first, int last);
  /// Adds to the momentum of a body in the last solution. Velocities and impulses change with the next descend().
  void push(int body, const Vector6d& momentum);
  /// The second half of solve(): from the roots to the leaves.
  void descend(int first, int last);
  const Vector6d& velocity(int body) const { return nodes_[body].velocity; }  // linear [m/s], angular [rad/s]
  const Impulses& impulses(int body) const { return nodes_[body].impulses; }  // of the rows of its joint

  /// Columns are halves of solutions: the effects of unit impulses. They are valid until clear_columns() or the next
  /// factor() or refactor(). Both functions return the index of a group of columns.
  /// Six columns: unit impulses on the linear and angular momentum of a body.
  int add_unit_columns(int body);
  /// One column: an impulse on the momentum of a body and its parent.
  int add_column(int body, const Vector6d& on_body, const Vector6d& on_parent);
  void clear_columns();
  int width(int group) const { return groups_[group].is_units ? 6 : 1; }
  /// The velocities along the impulses of one group that unit impulses of the other cause, width() x width(); 0 in
  /// different trees. `place`: of the first, in a matrix whose rows are `stride` apart.
  void multiply(int group, int other, double* place, std::size_t stride) const;

 private:
  /// Room for a joint's rows, padded with zeros: the operations on lines then have a constant length.
  static constexpr int padded = 8;
  template <int Rows, int Columns>
  using Block = Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor>;
  using Rest = Eigen::Matrix<double, padded, 1>;

  struct Node {
    Block<6, 6> mass =
        Block<6, 6>::Zero();  // of the articulated body; factored as R' R, with reciprocals on the diagonal
    Block<padded, padded> inner = Block<padded, padded>::Zero();  // the joint's factor, likewise
    Block<padded, 6> own = Block<padded, 6>::Zero();              // the joint's coupling to its body
    Block<6, padded> own_by_row = Block<6, padded>::Zero();       // the same, transposed
    Block<padded, 6> above = Block<padded, 6>::Zero();            // the coupling to the parent
    Vector6d t = Vector6d::Zero();                                // of the last solution, after the way to the root
    Rest u = Rest::Zero();
    Vector6d velocity = Vector6d::Zero();
    Impulses impulses{};
    bool is_stale = true;  // it has to be factored again; so have all from it to the root
  };
  /// What columns leave at a body of their path to the root.
  struct Half {
    Vector6d t;
    Rest u;
  };
  struct UnitHalf {
    Block<6, 6> t;
    Block<padded, 6> u;
  };
  struct Group {
    int body;  // where its path begins
    bool is_units;
    std::size_t begin;  // of its halves, by body
  };

  void load_mass(int body);
  void factor_body(int body);
  template <int Rows>
  void eliminate_joint(const TreeBody& of, Node& node);
  void add_to_parent(int body);
  /// One body of the way to the root: `t` is its momentum, and becomes a part of the solution like `u`, which is the
  /// right side of the joint. Adds the rest of the momentum to that of the parent, if it isn't null.
  void climb(int body, Vector6d& t, Rest& u, Vector6d* to_parent) const;
  /// The same with six columns at once and no right side.
  void climb(int body, UnitHalf& half, Block<6, 6>* to_parent) const;
  template <class First, class Second>
  void multiply(int body, const First* first, const Second* second, double* place, std::size_t stride) const;

  std::vector<TreeBody> bodies_;
  std::vector<Node> nodes_;
  std::vector<Group> groups_;
  std::size_t singles_ = 0, units_ = 0;  // number of groups of each kind
  std::vector<Half> halves_;             // by single column and body; only those on the path are set
  std::vector<UnitHalf> unit_halves_;    // by group of six and body, likewise
};

}  // namespace rehearse
