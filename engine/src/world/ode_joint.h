// OdeJoint: one movable joint in ODE, a hinge or a slider, with its drive, its stops, damping, rotor, spring and
// friction.
// Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/actuator.h>
#include <rehearse/io.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "gear_play.h"
#include "joint_guide.h"
#include "simulated_body.h"
#include "solver/island.h"

namespace rehearse {

/// The limits that are applied to a joint.
struct KeptLimits {
  bool displacement = false;  // stops at lower and upper
  bool effort = false;        // commanded efforts are clamped
};

/// What the direct solver found of a joint in a step.
struct SolvedJoint {
  double rate = 0.0;    // at the step's end, about the axis of its beginning [rad/s] or [m/s]
  double effort = 0.0;  // of the drive or the coupling [N·m] or [N]
};

class OdeJoint {
 public:
  /// `joint` and `actuator` must outlive this; `actuator` null: the joint has none. `parent` may be null: the world.
  /// `frame`: the child link's pose at displacement 0, which is the bodies' current pose.
  OdeJoint(dWorldID world, const Joint& joint, dBodyID child, dBodyID parent, const Eigen::Isometry3d& frame,
           KeptLimits kept, const Actuator* actuator = nullptr);
  OdeJoint(OdeJoint&&) = default;

  const Joint& joint() const { return joint_; }
  double displacement() const;  // [rad] or [m]; unwrapped
  /// [rad/s] or [m/s], at the end of the last step; of a slider, that in the turning frame of its parent.
  double rate() const { return rate_; }
  JointReading reading() const { return {displacement(), rate_, acceleration_, effort_}; }

  /// Takes the motion of the bodies. `displacement`: of their current poses, with the whole turns, which ODE's wrapped
  /// angle doesn't contain.
  void begin(double displacement);
  void before_step(double time_step);
  /// Call it when the state was replaced.
  void after_restore() {
    if (revolute_) rate_ = rate_of_bodies();
  }
  /// After ODE's step: the impulse that would give both bodies one velocity at the joint [N·s].
  double missing_impulse() const;
  /// After ODE's step: the difference between the joint's velocity and its drive's; 0 without a drive, and for one
  /// that is at its effort limit [rad/s] or [m/s].
  double missed_velocity() const;
  /// True if resist() has to be called.
  bool resists() const {
    return joint_.damping > 0.0 || joint_.armature > 0.0 || joint_.spring_stiffness > 0.0 || play_ ||
           (actuator_ && actuator_->stall_effort);
  }
  /// True if resist() needs the inertia.
  bool damps() const { return joint_.damping > 0.0 || slope_ > 0.0; }
  /// The effort of the coming step's command falls by that with the velocity [N·m·s] or [N·s/m].
  void lean_effort(double slope) { slope_ = slope; }
  /// Of a gear with backlash: moves the rotor by the command in the coming step. Must be called before resist().
  void turn_rotor(const JointCommand& command, double time_step);
  /// Null: the gear has no backlash.
  const GearPlay* play() const { return play_ ? &*play_ : nullptr; }
  /// Sets damping, rotor inertia and spring for the coming step. `inertia`: about the joint's axis without the rotor
  /// [kg·m²], or along it [kg].
  void resist(double inertia, double time_step);
  /// From now on a drive has that share of its effort limit, and at most that effort [N·m] or [N]; a share of infinity:
  /// no limit.
  void limit_drive(double share, double most) {
    drive_share_ = share;
    drive_most_ = most;
  }
  /// Sets motor and force for the coming step. A gear with backlash exerts the effort of its rotor instead.
  void drive(const JointCommand& command, double time_step);
  /// Sets motor and force for a joint that follows `leader`: it is driven to the displacement to which the leader's
  /// motion takes it in the step.
  void follow(const OdeJoint& leader, double time_step);
  void after_step(double time_step);

  // For the direct solver, between drive() and after_step(). Indices of bodies are left for the caller to set.
  /// Sets the joint of a body: its motion, its damping, and a drive without limit.
  void describe(const StepLaw& law, const JointBodies& bodies, TreeBody& body) const;
  /// The drive with a limit, or the dry friction.
  std::optional<LimitedDrive> limited_drive(const StepLaw& law) const;
  /// The stops of the joint.
  std::optional<Stop> stops(const StepLaw& law) const;
  /// Of a joint that follows: the row by which it moves as `leader` does, and the leader carries its load.
  JointRow coupling(const StepLaw& law, const OdeJoint& leader) const;
  /// True if a drive without limit turns the joint so far that the step's velocities, which are those of its beginning,
  /// miss the target.
  bool turns_far(double time_step) const;
  /// The child's pose after such a step. `parent`: its pose after the step.
  std::optional<BodyPose> driven_pose(const BodyPose& parent, double time_step) const;
  /// True if a sensor reads child_wrench().
  bool is_measured() const { return measured_; }
  void take_solution(const SolvedJoint& solved) { solved_ = solved; }
  /// The whole joint's force and torque on the child.
  void take_wrench(const Vector6d& wrench);

  Eigen::Vector3d world_axis() const;
  Eigen::Vector3d anchor() const;  // of a revolute joint [m]
  bool revolute() const { return revolute_; }

  /// From now on child_wrench() returns measurements.
  void measure_wrench() {
    measured_ = true;
    read_feedback();
  }
  /// The joint's wrench on its child in the last step; the torque is about the child's centre of mass. World axes.
  Wrench child_wrench() const;

  // The parts of the state, in groups: a body saves the turns of all its joints, then all efforts, and so on.
  void visit_turns(StateVisitor& visitor) {
    visitor.visit(&turns_, sizeof turns_);
    visitor.visit(revolute_ ? wrapped_ : rate_);  // the rate of a hinge follows from the bodies
  }
  void visit_effort(StateVisitor& visitor) { visitor.visit(effort_); }
  void visit_acceleration(StateVisitor& visitor) { visitor.visit(acceleration_); }
  void visit_play(StateVisitor& visitor) {
    if (play_) play_->visit_state(visitor);
  }

 private:
  void create_resistance(dWorldID world, dBodyID parent, const Eigen::Vector3d& axis);
  void set(int parameter, double value);
  double get(int parameter) const;
  double get_resistance(int parameter) const;
  void set_resistance(int parameter, double value);
  void set_stops(bool active);
  double beyond(double displacement) const;
  void ease_stops(double time_step);
  void set_motor(double velocity, double limit);
  void drive_to(double displacement, double rate, double time_step);
  void drive_at(double velocity, double time_step);
  void apply_effort(double time_step);
  void apply_resistance();
  void read_feedback();
  bool is_resisted() const;
  double rate_of_bodies() const;
  double turn_of(double time_step) const;
  double motor_effort() const;
  double drive_limit() const;
  double dry_friction() const;

  const Joint& joint_;
  const Actuator* actuator_;
  dBodyID child_;
  KeptLimits kept_;
  bool revolute_;
  bool measured_ = false;          // a sensor reads its wrench
  dJointID ode_ = nullptr;         // destroyed with its world
  dJointID resistance_ = nullptr;  // a motor of ODE for damping and rotor inertia; null: there are none
  std::unique_ptr<dJointFeedback> feedback_, resistance_feedback_;
  std::optional<JointGuide> guide_;  // always set
  std::optional<GearPlay> play_;     // nullopt: no backlash; its rotor is then part of the joint
  // state
  int turns_ = 0;              // whole turns on top of ODE's angle, which lies in [-pi, pi]
  double wrapped_ = 0.0;       // ODE's angle after the last step [rad]
  double effort_ = 0.0;        // of the actuator in the last step [N·m] or [N]
  double acceleration_ = 0.0;  // over the last step
  double rate_ = 0.0;          // of a slider; that of a hinge is known from the bodies
  // scratch within a step
  double previous_rate_ = 0.0;
  std::optional<SolvedJoint> solved_;                      // nullopt: ODE made the step
  double previous_effort_ = 0.0;                           // of the actuator, in the last step
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitX();        // of the joint at the step's beginning; world
  Eigen::Vector3d arm_ = Eigen::Vector3d::Zero();          // from the child's centre of mass to the joint [m]
  Eigen::Vector3d parent_arm_ = Eigen::Vector3d::Zero();   // from the parent's [m]
  Eigen::Vector3d correction_ = Eigen::Vector3d::Zero();   // velocity by which ODE corrects the joint's error [m/s]
  double applied_ = 0.0;                                   // effort added as an external force
  Eigen::Vector3d even_torque_ = Eigen::Vector3d::Zero();  // that ODE adds on both sides of a slider's force [N·m]
  double motor_velocity_ = 0.0;                            // of ODE's joint motor, if it is on
  double motor_limit_ = 0.0;                               // of its effort
  double drive_share_ = 1.0;                               // of its limit that a fault leaves
  double drive_most_ = unlimited;                          // that its heat allows
  double slope_ = 0.0;                                     // of the effort over the velocity
  double mean_slope_ = 0.0;                                // over the velocity at the step's end
  double resistance_gain_ = 0.0;                           // of damping, rotor and spring [N·m·s] or [N·s/m]
  double resistance_velocity_ = 0.0;                       // at which they exert no effort
  double spring_effort_ = 0.0;                             // at the beginning of the step [N·m] or [N]
  bool motor_on_ = false;                                  // ODE's joint motor has a force limit above zero
  bool stops_active_ = false;                              // ODE's stops are set; they are off while a motor drives
  bool eases_ = false;                                     // they push back at less than ODE's rate
  bool motor_drives_ = false;                              // the motor is the actuator, not dry friction
};

}  // namespace rehearse
