// World: the simulated bodies, their joints and contacts, in ODE.
//
// A World is made of Models, each with a pose, and advances in steps of a fixed length. Input: a Command (the
// controllers' commands to the joints) and pushes. Output: an Observation (sensor readings and state). A World stores
// everything that the next step depends on, including its random generator: two worlds in one process never influence
// each other, and the same calls give the same bits. Use a World from one thread at a time. Cameras and the scan cycle
// of range sensors are not part of it.
//
// Links joined by fixed joints are one rigid body for the physics; each keeps its own frame in the Observation.
// Links of one body touch each other only if the links or the body's description enable it. Links that are connected by
// one joint or by fixed joints never touch each other, nor do links that overlap when all joints are at zero. Contacts
// are found pair by pair in the order of the bodies and their shapes. So the order of contacts, on which the solver
// depends, is determined by the scenario alone.
#pragma once

#include <rehearse/actuator.h>
#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/world_settings.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rehearse {

/// One body, its initial pose and its initial velocity.
struct WorldBody {
  std::string name;
  std::shared_ptr<const Model> model;
  bool fixed = false;                                            // the root link never moves
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            // of the root link [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // of the root link, unit
  std::vector<double> joints;                                    // displacement by joint id [rad] or [m]
  bool kinematic = false;                                        // the body moves as commanded, without dynamics
  bool joint_limits = false;                                     // joints stop at their limits
  bool effort_limits = false;                                    // commanded efforts are clamped to their limits
  bool drive_limits = true;     // drives of displacement and velocity keep to the limits of effort and velocity
  bool touches = true;          // its shapes have contacts
  bool self_collision = false;  // all links of the body touch each other, not only those with collides_with_own
  Eigen::Vector3d linear_velocity = Eigen::Vector3d::Zero();   // of the root link's origin, world [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // of the root link, world [rad/s]
  std::vector<double> joint_velocities = {};                   // by joint id [rad/s] or [m/s]; empty: zero
  std::vector<std::string> materials = {};  // by link index, for pairs; empty names and an empty list: none
  bool planar = false;  // a root link that isn't fixed stays in the plane of x and z in which it begins
  /// By joint id; nullopt: the joint is ideal. An empty list: all are. Tracks and joints that follow others have none.
  std::vector<std::optional<Actuator>> actuators = {};
  std::vector<MassFault> mass_faults = {};  // parts that nothing moves by forces have no use for them
};

/// A joint, by the link that it moves; `body` -1: none.
struct JointPlace {
  int body = -1;
  int link = -1;  // index into the model's links
};

/// The errors at which the quick solver stopped in a step.
struct Residual {
  JointPlace joint;    // with the largest missing force; none: no body has a joint
  double share = 0.0;  // that force, as a share of the body's weight
  JointPlace missed;   // the joint that misses the velocity of its drive most; none: all reach it
  double velocity =
      0.0;             // by which it misses it, or drifts while it is held; at an effort limit it may [rad/s] or [m/s]
  int iterations = 0;  // of the quick solver in that step; 0: it moved no body
};

/// The parts of a step that the direct solver didn't solve to the end.
struct Unsolved {
  double share = 0.0;     // the largest error of a force, as a share of the weight of the bodies that touch; 0: none
  int contacts = 0;       // of an island that was left to the quick solver, as it has too many; 0: none
  int most_contacts = 0;  // that the direct solver takes
  /// The largest force that is missing at a contact of such islands, as a share of the lighter body's weight: it would
  /// stop the approach that is left after the step (reduced mass).
  double contact_share = 0.0;
};

class World {
 public:
  /// Fails, naming body and link, if ODE could not simulate a body: mass or inertia not positive, a count of joints
  /// that doesn't fit, a mesh that wasn't loaded, a connection of links that never move.
  static Result<std::unique_ptr<World>> create(const WorldSettings& settings, std::vector<WorldBody> bodies);
  /// Warnings about behaviour that the bodies' authors may not expect: links that touch no other link of their body
  /// because they overlap with it at the zero pose.
  Diagnostics remarks() const;
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// The state at the beginning of the coming step. Joint sensors and inertial sensors are `fresh` after the first
  /// step; before it they read zero, as in Choreonoid. Accelerations are the change of velocity over the last step
  /// divided by its length, which for ODE's semi-implicit Euler step is the acceleration the step used (ODE reports
  /// none). Valid until the next call of step() or restore(). Its cameras and range sensors are empty.
  const Observation& sense() const;

  /// The measurement of a range sensor now: for each beam the distance of the nearest collision shape [m], rounded to
  /// float; +inf if there is none up to the maximum distance. A beam begins at the minimum distance: it passes through
  /// nearer shapes, and through shapes that contain its beginning. The sensor doesn't see its own link, nor links that
  /// fixed joints connect to it.
  std::vector<float> measure_ranges(int body, int device) const;

  /// From now on the body's observation contains the contacts of the link's collision shapes:
  /// BodyObservation::contacts, one list per link, empty for links that are not watched. Points and depths are those at
  /// the beginning of the last step, where ODE found them. The force acted during the step; the velocity is that of the
  /// two surfaces after the step, running belts included. Two links that no force moves have no contacts. Watching
  /// changes nothing in the simulation, and contacts are not part of its state: after restore() the lists are empty
  /// until the next step.
  void watch(int body, int link);

  /// The pairs of links that touched in the last step, at their poses at its beginning; ascending, each pair once. Two
  /// links that no force moves don't touch. The list is not part of the state: it is empty before the first step, and
  /// after restore() until the next step. Valid until the next call of step() or restore().
  const std::vector<LinkPair>& touching() const;

  /// ODE's message if the exact solver found no solution for the last step, else empty. That step was made by the quick
  /// solver with 1000 iterations instead. Not part of the state.
  const std::string& solver_message() const;

  /// The residual of the last step, of the bodies that the quick solver moved. Parts that a joint connects have
  /// different velocities at its anchor, by more than the joint's correction of its error; the missing force is what
  /// would stop the lighter of both parts within the step, the other one free to move (reduced mass). That force is
  /// small where a part is light; the velocity that a drive misses isn't. Not part of the state: after restore() it is
  /// empty until the next step.
  const Residual& residual() const;

  /// Of the last step. Not part of the state.
  const Unsolved& unsolved() const;

  /// The connections that began or ended at the beginning of the last step:
  /// "holder 'Arm/HAND' took hold of 'Box/BASE'". Not part of the state.
  const std::vector<std::string>& events() const;

  /// Commands a rotor or a holder; the command has effect from the coming step on. `values`: the device's state in the
  /// form of cnoid's writeState(). Has no effect on other devices.
  void command_device(int body, int device, const std::vector<double>& values);

  /// Sets the joint commands and the external wrenches. Joint commands apply from the coming step on until the next
  /// call; wrenches act on the links during the coming step only. Every number in `command` must be finite.
  void actuate(const Command& command);

  /// Applies a force [N] at a point of the link [m, link frame] and a torque [N·m], both in world axes, during the
  /// coming step.
  void push(int body, int link, const Eigen::Vector3d& force, const Eigen::Vector3d& point,
            const Eigen::Vector3d& torque);

  /// Simulates one step. Returns false if the simulation has exploded: the state is no longer finite, or a body is
  /// faster than 1e8 m/s or rad/s. The world can then only be destroyed.
  bool step();

  /// Number of steps done.
  std::int64_t tick() const;
  /// Simulated time: tick() divided by the rate [s].
  double time() const;

  /// 64-bit hash (XXH3) of the bytes that save() returns.
  std::uint64_t state_hash() const;
  /// The raw state: everything that the next step depends on, except its inputs (the command and the pushes). If the
  /// state is restored into this world, or into one made from the same settings and bodies, the run continues with the
  /// same bits.
  std::vector<std::byte> save() const;
  /// Restores a state that save() returned. Fails if `state` is not from a world like this one.
  Result<void> restore(std::span<const std::byte> state);
  /// Takes the state of another world, whose bodies, links, joints and devices may differ or have a different order:
  /// parts are matched by name. Each link gets the pose that it has in `other`, even if the centres of mass differ.
  /// Fails, naming them, if parts of this world are missing in `other`; the state of this world is then unusable. A
  /// device that is missing in `other` keeps its last measurement.
  Result<void> take_state(const World& other);

  /// Changes the last bit of the positions of free bodies: each coordinate of each rigid body's position becomes the
  /// next number above or below, depending on the bits of a hash of `pattern`; zeros stay. The effect on a run shows
  /// how much rounding can change it.
  void nudge(std::uint32_t pattern);

  /// The version of ODE that was linked and its precision, for provenance.
  static std::string engine_description();

 private:
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
