// Forest: the velocities of trees of rigid bodies in the coordinates of their joints. Private to the engine.
//
// With the masses M, and the momentum g of the bodies after a step without constraints, the velocities v of a step are
// those of the least
//     v' M v / 2 - g' v + sum over dampers and drives of (target - q)^2 / (2 softness)
// among all that the joints allow (joint_motion.h). The coordinates are eliminated from the leaves to the roots: what
// is left of a body is its articulated inertia, as the parent feels it (R. Featherstone, Rigid Body Dynamics
// Algorithms, 2008, chapter 7). A body that no joint guides has six coordinates, one after the other. The time is
// linear in the number of bodies. Sums are in a fixed order, so that bits don't depend on compilers and processors.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "joint_motion.h"

namespace rehearse {

/// A drive that holds: q + softness x = target, with its impulse x on the coordinate.
struct HeldDrive {
  double target = 0.0;
  double softness = 0.0;
};

/// A rigid body and the joint that connects it to its parent or to the world.
struct TreeBody {
  int parent = -1;                                    // index of the parent, less than its own; -1: the world, or none
  double mass = 0.0;                                  // [kg]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // about the centre of mass, world axes [kg·m²]
  Vector6d momentum = Vector6d::Zero();  // after a step without constraints: linear [N·s], angular [N·m·s]
  JointMotion joint;
  // Of a joint with one coordinate, which moves at the rate q. Impulses on it [N·m·s] or [N·s]:
  double gain = 0.0, offset = 0.0;  // of dampers, springs and rotors: offset - gain q
  double push = 0.0;                // a known one
  std::optional<HeldDrive> drive;
};

class Forest {
 public:
  std::vector<TreeBody>& bodies() { return bodies_; }
  const std::vector<TreeBody>& bodies() const { return bodies_; }

  /// Gives the coordinates their places. Call it when the bodies or their joints were set.
  void arrange();
  /// Factors the bodies from `first` to the one before `last`, which are whole trees. A changed gain or drive needs a
  /// new factor; a changed momentum, offset, push or target doesn't.
  void factor(int first, int last);
  /// The drive of a body changes after factor(), its masses don't: refactor() must follow.
  void change_drive(int body);
  /// Factors again what depends on changed drives: their bodies, and all from there to the root. Each bit is that of
  /// factor().
  void refactor(int first, int last);
  /// Computes the velocities of these bodies.
  void solve(int first, int last);
  /// Adds to the momentum of a body, or an impulse on the coordinate of its joint, in the last solution. Velocities
  /// change with the next descend().
  void push(int body, const Vector6d& momentum);
  void push_joint(int body, double impulse);
  /// The second half of solve(): from the roots to the leaves.
  void descend(int first, int last);

  const Vector6d& velocity(int body) const { return nodes_[body].velocity; }  // linear [m/s], angular [rad/s]
  /// Of the joint's one coordinate.
  double rate(int body) const { return coordinates_[nodes_[body].begin].rate; }
  /// Of the drive that holds the joint.
  double drive_impulse(int body) const { return coordinates_[nodes_[body].begin].impulse; }
  /// Computes the joints' impulses on these bodies, whole trees: all that isn't in the momentum or pushed.
  void find_wrenches(int first, int last);
  const Vector6d& wrench(int body) const { return nodes_[body].wrench; }

  /// Columns are halves of solutions: the effects of unit impulses. They are valid until clear_columns() or the next
  /// factor() or refactor(). Both functions return the index of a group of columns.
  /// Six columns: unit impulses on the linear and angular momentum of a body.
  int add_body_columns(int body);
  /// One column: a unit impulse on the coordinate of a joint.
  int add_joint_column(int body);
  void clear_columns() { groups_.clear(), bodies_with_columns_ = joints_with_columns_ = 0; }
  int width(int group) const { return groups_[group].is_body ? 6 : 1; }
  /// The velocities along the impulses of one group that unit impulses of the other cause, width() x width(); 0 in
  /// different trees. `place`: of the first, in a matrix whose rows are `stride` apart.
  void multiply(int group, int other, double* place, std::size_t stride) const;

 private:
  using Matrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;
  using Line = Eigen::Matrix<double, 1, 6>;

  struct Coordinate {
    Vector6d axis;          // S
    Vector6d reaction;      // of the articulated body to its motion: I S
    double inertia = 0.0;   // S' I S, and the gain
    double yield = 0.0;     // 1 / (1 + softness inertia), or without a drive 1 / inertia
    double mobility = 0.0;  // the rate by a unit impulse
    double softness = 0.0;  // of the drive
    double target = 0.0;    // likewise
    double offset = 0.0;    // known impulses
    double u = 0.0;         // impulse on it, with what comes from beyond
    double rate = 0.0;      // q
    double impulse = 0.0;   // of the drive
    bool is_driven = false;
    double rate_alone() const { return is_driven ? (softness * u + target) * yield : u * yield; }
  };
  struct Node {
    Matrix inertia;    // of the articulated body; after its elimination what the parent gets
    Vector6d of_bias;  // its momentum by the bias
    Vector6d g;        // momentum, and what comes from beyond
    Vector6d pushed;   // since solve()
    Vector6d velocity, wrench;
    int begin = 0, end = 0;  // of its coordinates
    bool is_stale = true;    // it has to be factored again; so have all from it to the root
  };
  struct Group {
    int body;  // where its path begins
    bool is_body;
    std::size_t begin;  // of its halves, by coordinate
  };

  void load(int body);
  void eliminate(int body);
  /// An impulse's way from a body to the root: `done` gets each coordinate and its share.
  template <class Done>
  void climb(int body, Vector6d momentum, double on_joint, Done&& done);
  template <int Width, int Other>
  void multiply(int body, const Group& first, const Group& second, double* place, std::size_t stride) const;

  std::vector<TreeBody> bodies_;
  std::vector<Node> nodes_;
  std::vector<Coordinate> coordinates_;
  std::vector<Group> groups_;
  std::size_t bodies_with_columns_ = 0, joints_with_columns_ = 0;
  std::vector<Line> body_halves_;     // by group and coordinate; only those on the path are set
  std::vector<double> joint_halves_;  // likewise
};

}  // namespace rehearse
