// World: the simulated bodies, their joints and contacts, in ODE.
//
// A World is made of Models, each with a pose, and goes forward in steps of a fixed length. In: a Command (what the
// controllers want of the joints) and pushes. Out: an Observation (what the sensors and the state say). It owns all
// that the next step depends on, its random generator included: two worlds in one process never influence each other,
// and the same calls give the same bits. One thread at a time. Cameras are not here, nor is the
// cycle in which range sensors scan.
//
// Links joined by fixed joints are one rigid body for the physics; each keeps its own frame in the Observation.
// Links of one body touch each other only if they or the body's description say so, and never those that one joint or
// fixed joints hold together, nor those that overlap when all joints are at zero. Contacts are found pair by pair in
// the order of the bodies and their shapes, so that their order, which the solver depends on, is that of the scenario
// and of nothing else.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/scene_settings.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rehearse {

struct WorldSettings {
  double time_step = 0.001;                     // [s]
  Eigen::Vector3d gravity{0.0, 0.0, -9.80665};  // [m/s²]
  std::uint32_t seed = 0;
  SolverSettings solver;
};

/// One body and where it starts, at rest.
struct WorldBody {
  std::string name;
  std::shared_ptr<const Model> model;
  bool fixed = false;                                            // the root link never moves
  Eigen::Vector3d position = Eigen::Vector3d::Zero();            // of the root link [m]
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // of the root link, unit
  std::vector<double> joints;                                    // displacement by joint id [rad] or [m]
  bool kinematic = false;                                        // it moves as it is commanded, without dynamics
  bool joint_limits = false;                                     // joints stop at their limits
  bool effort_limits = false;                                    // commanded efforts are clamped to their limits
  bool trimesh = false;         // meshes of links that never move are touched as they are, not as their hulls
  bool self_collision = false;  // all its links touch each other, not only those that say so
};

class World {
 public:
  /// Fails, naming body and link, if ODE could not simulate a body: mass or inertia not positive, a count of joints that
  /// doesn't fit, a mesh that wasn't loaded.
  static Result<std::unique_ptr<World>> create(const WorldSettings& settings, std::vector<WorldBody> bodies);
  /// What was done with the bodies that their authors may not expect, as warnings: links that touch nothing of their
  /// own body because they overlap with it at the zero pose.
  Diagnostics remarks() const;
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// The state at the beginning of the coming step. Joint sensors and inertial sensors are `fresh` after the first
  /// step; before it they read zero, as in Choreonoid. Accelerations are the change of velocity over the last step
  /// divided by its length, which for ODE's semi-implicit Euler step is the acceleration the step used (ODE reports
  /// none). Valid until the next call of step() or restore(). Its cameras and range sensors are empty.
  const Observation& sense() const;

  /// What a range sensor measures now: for each beam the distance of the nearest collision shape [m], rounded to float;
  /// +inf if there is none up to the maximum distance. Nearer than the minimum distance nothing is seen, nor a shape
  /// that holds that point of the beam. The sensor's link, and links that fixed joints hold to it, aren't seen.
  std::vector<float> measure_ranges(int body, int device) const;

  /// From now on the body's observation tells what touches the link's collision shapes: BodyObservation::contacts, one
  /// list a link, empty for those that nobody watches. Points and depths are those at the beginning of the last step,
  /// where ODE found them; the force is what the contact did in the step, the velocity that of the two surfaces after
  /// it, running belts included. Two things that no force moves have no contacts. Watching changes nothing in the
  /// simulation, and contacts are not part of its state: after restore() the lists are empty until the next step.
  void watch(int body, int link);

  /// Which links touched in the last step, where they were at its beginning; ascending, each pair once. Two things that
  /// no force moves don't touch. It is no part of the state: before the first step, and after restore() until the next
  /// one, there are none. Valid until the next call of step() or restore().
  const std::vector<LinkPair>& touching() const;

  /// What drives the joints from the coming step on, until another command comes, and the external wrenches that act on
  /// the links during the coming step only. Every number in it must be finite.
  void actuate(const Command& command);

  /// A force [N] at a point of the link [m, link frame] and a torque [N·m], both in world axes, during the coming step.
  void push(int body, int link, const Eigen::Vector3d& force, const Eigen::Vector3d& point,
            const Eigen::Vector3d& torque);

  /// One step. False if the state is no longer finite (the simulation has exploded): the world can only be destroyed
  /// then.
  bool step();

  /// Steps done, and their number divided by the rate [s].
  std::int64_t tick() const;
  double time() const;

  /// 64-bit hash (XXH3) of all that save() saves.
  std::uint64_t state_hash() const;
  /// Everything the next step depends on, raw, but for what is handed in for each step: the command and the pushes.
  /// Restored into this world, or one made from the same settings and bodies, the run goes on with the same bits.
  std::vector<std::byte> save() const;
  /// Fails if `state` is not of a world like this one.
  Result<void> restore(std::span<const std::byte> state);
  /// The same from another world, whose bodies, links, joints and devices may be others or stand in another order: each
  /// part is taken from the one of its name. Links come to be where they are there, whatever their centres of mass.
  /// Fails, naming them, if parts of this world aren't in the other; its state is good for nothing then. A device that
  /// the other hasn't keeps its last measurement.
  Result<void> take_state(const World& other);

  /// Moves what moves freely by a last bit: each coordinate of each rigid body's position to the next number above or
  /// below, as the bits of a hash of `pattern` say; zeros stay. What that makes of a run is what rounding can make of it.
  void nudge(std::uint32_t pattern);

  /// The version of ODE that was linked and its precision, for provenance.
  static std::string engine_description();

 private:
  struct Impl;
  explicit World(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace rehearse
