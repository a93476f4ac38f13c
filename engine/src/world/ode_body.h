// OdeBody: a body that moves by its dynamics. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <optional>
#include <vector>

#include "actuator_stage.h"
#include "force_sensors.h"
#include "initial_motion.h"
#include "joint_inertia.h"
#include "model/rigid_groups.h"
#include "ode_joint.h"
#include "ode_math.h"
#include "plane_constraint.h"
#include "rigid_group.h"
#include "simulated_body.h"

namespace rehearse {

/// A link whose surface runs as a belt.
struct Track {
  int link = 0;
  double speed = 0.0;  // in the last step, and in the coming one [m/s]
};

class OdeBody final : public SimulatedBody {
 public:
  /// `description` has passed check_dynamics().
  OdeBody(dWorldID world, WorldBody description, double time_step);

  void before_step(double time) override;
  bool changes_mass() const override { return changes_mass_; }
  void drive(const BodyCommand& command) override;
  void add_wrench(int link, const Eigen::Vector3d& force, const Eigen::Vector3d& torque_about_origin) override;
  Eigen::Vector3d link_point(int link, const Eigen::Vector3d& point_in_link) const override;
  Belt belt(int index) const override;
  Mount mount(int link) const override;
  JointErrors residual() const override;
  void after_step() override;
  void observe(BodyObservation& observation, const WorldSettings& settings, bool stepped) const override;
  bool plausible() const override;
  std::vector<dBodyID> ode_bodies() const override;
  std::vector<MovingPart> moving_parts() override;
  void visit_state(StateVisitor& visitor) override;
  void after_restore() override;
  void take_centers(const SimulatedBody& other) override;
  void nudge(std::uint64_t bits) override;

 private:
  void read_force(std::size_t device, std::vector<double>& values) const override;
  void create_groups(dWorldID world, const RigidGroups& groups, const std::vector<Eigen::Isometry3d>& zero_posture);
  void create_joints(dWorldID world, const std::vector<Eigen::Isometry3d>& zero_posture);
  void create_shapes();
  void release_weightless();
  void hold_up_weightless();
  bool has_weight(int group) const;
  void resist_motions();
  std::vector<RigidPart> rigid_parts() const;
  /// Null: the joint of that id is ideal.
  const Actuator* actuator_of(int id) const;
  void act(const BodyCommand& command);
  void observe_actuators(BodyObservation& observation) const;
  void turn_freely();
  void give_motion(int link, const GivenMotion& motion);
  static void place_shape(dGeomID geom, const RigidGroup& group, const Eigen::Isometry3d& in_group);
  void set_posture(const std::vector<Eigen::Isometry3d>& poses);
  void set_velocities(const std::vector<LinkMotion>& motions);
  const RigidGroup& group_of(int link) const { return groups_[links_[link].group]; }
  double mass_factor(std::size_t group, double time) const;
  void take_masses(double time);
  static void set_mass(RigidGroup& group, double factor);
  void read_link(int index, LinkReading& link) const;

  /// The index of a joint id in joints_ or in tracks_.
  struct Slot {
    bool is_track;
    int index;
  };

  double time_step_;
  Eigen::Vector3d gravity_;
  std::vector<GroupedLink> links_;
  std::vector<RigidGroup> groups_;
  std::vector<Slot> slots_;                           // by joint id
  std::vector<OdeJoint> joints_;                      // movable ones, by joint id
  double moving_mass_ = 0.0;                          // of all groups that aren't fixed to the world [kg]
  bool changes_mass_ = false;                         // with the coming step
  bool has_resistance_ = false;                       // of any joint: damping or rotor inertia
  std::vector<std::optional<ActuatorStage>> stages_;  // by joint id; empty: the body has no actuators
  std::vector<JointCommand> acting_;                  // scratch within a step: the commands behind the actuators
  std::vector<Track> tracks_;                         // by joint id
  std::optional<PlaneConstraint> plane_;              // of the root
  std::optional<ForceSensors> force_sensors_;         // after construction always
};

}  // namespace rehearse
