// DirectStep: the part of a step that Rehearse solves itself. Private to the world library.
//
// ODE has the bodies, the shapes and their contacts. The velocities of their islands at the end of the step are
// computed here, in the coordinates of the joints (solver/forest.h); contacts and limits have bounds (solver/island.h).
// The equations are those of ODE's joints, so a robot at rest has the velocities of ODE's exact solver, at a cost that
// is linear in the links. Islands with many contacts are left to ODE.
#pragma once

#include <ode/ode.h>
#include <rehearse/model.h>
#include <rehearse/world_settings.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "connections.h"
#include "joint_guide.h"
#include "simulated_body.h"
#include "solver/island.h"
#include "touches.h"

namespace rehearse {

class DirectStep {
 public:
  /// Islands with more contacts are left to ODE: the cost grows with the third power of their number. Bodies without
  /// joints have a limit of their own: stacks need many more steps of the solver.
  static constexpr int most_contacts = 100, most_loose_contacts = 48;

  /// The contacts of an island that was left to ODE.
  struct Crowd {
    int contacts = 0;  // 0: there is none
    int most = 0;      // that are solved here
  };
  struct Outcome {
    bool finite = true;
    double error = 0.0;  // the largest of an impulse, as a share of the island's weight
    Crowd crowd;         // the largest
  };

  /// `bodies` must outlive this. `most_velocity`: ODE's limit of the velocity that separates shapes [m/s].
  DirectStep(const WorldSettings& settings, double most_velocity,
             const std::vector<std::unique_ptr<SimulatedBody>>& bodies);

  /// Before the contacts of a step are added: finds the islands.
  void begin(const Touches& touches, const Connections& connections);
  /// True if both bodies of the contact are solved here, as far as they move.
  bool solves(const Touches::Contact& touch) const;
  /// Adds a contact that solves() accepts. `estimate`: of its force on a [N].
  void add(Touches::Contact& touch, const dContact& contact, const Eigen::Vector3d& estimate);
  /// True if ODE has to make a step for other bodies.
  bool leaves_bodies() const { return leaves_bodies_; }
  /// Solves the islands and moves their bodies. ODE's feedback then has the forces of joints and contacts.
  Outcome solve();
  /// Bodies that are solved here are disabled for ODE's step, or enabled again.
  void hide_from_ode(bool hidden) const;

 private:
  struct Tree {
    int first, last;           // parts
    bool has_joint = false;    // or another equation
    bool is_measured = false;  // a sensor reads the wrench of a joint
    int island = -1;           // index into islands_; -1: left to ODE
    int offset = 0;            // of its bodies in the forest, from `first`
  };
  struct JointPlace {
    int drive = -1, stop = -1, coupling = -1;  // index into the island's drives, stops and joint rows
  };
  struct ContactPlace {
    Touches::Contact* touch;
    int island;
    int row;                                    // the first
    int count;                                  // of rows with a force
    std::array<Eigen::Vector3d, 3> directions;  // of these forces, on the first body
  };

  int part_of(dBodyID body) const;
  int tree_of(dBodyID body) const;
  int forest_body(dBodyID body) const;
  void find_islands(const Touches& touches, const std::vector<const JointGuide*>& connections);
  void load();
  void load_body(int part, TreeBody& body);
  void load_joint(int part, Island& island);
  void couple(int part, Island& island);
  void add_connection(const JointGuide& guide);
  /// The row between two of ODE's bodies, of which at least one is solved here.
  BoundedRow row_between(const Row& row, dBodyID first, dBodyID second) const;
  void finish_joints(const Tree& tree);
  void move(int part, const Island& island) const;
  void turn_to_targets(const Tree& tree) const;

  StepLaw law_;
  double most_velocity_, surface_layer_, erp_;
  Eigen::Vector3d gravity_;
  std::vector<MovingPart> parts_;
  std::vector<int> trees_of_;  // by part
  std::vector<int> parents_;   // by part: the parent's part; -1: none
  std::vector<int> leaders_;   // by part: that whose joint its own follows; -1: none
  std::vector<Tree> trees_;
  // of the step
  Forest forest_;
  std::vector<Island> islands_;
  std::vector<bool> have_joints_;  // by island
  std::size_t island_count_ = 0;
  std::vector<BodyMotion> motions_;       // by part, at the beginning
  std::vector<JointPlace> joint_places_;  // by part
  std::vector<ContactPlace> contacts_;
  bool leaves_bodies_ = false;
  Crowd crowd_;
};

}  // namespace rehearse
