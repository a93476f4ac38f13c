// Actuator: the properties of a joint's drive as it is built. They lie between a command and the effort at the joint.
//
// A command passes through the parts in this order: quantum, delay, the drive's own loop, bandwidth, limits, backlash,
// losses of the gear and of the joint. A part that isn't given passes everything unchanged. All numbers are those at
// the joint, after the gear.
//
// - Delay: a command acts from its tick on, plus `delay`. In each step the mean of the commands in force acts, so that
//   parts of a step count. Before the first command the joint is commanded to its initial displacement without effort.
// - Jitter: the delay of each command lies evenly between delay - jitter and delay + jitter. Of commands that overtake
//   each other the newest is in force.
// - The drive's own loop turns commands of displacement and velocity into an effort, every `period`:
//   position_gain (q* - q) + velocity_gain (dq* - dq) + u*. Quantities that aren't commanded are left out; without a
//   commanded velocity dq* is 0. Between two periods the effort stays. Without a loop, a drive follows its commands
//   exactly, up to its limits.
// - Bandwidth: a first-order lag of the effort, T u' = u* - u with T = 1 / (2 pi bandwidth). In each step its mean
// acts.
// - Limits: the effort of a direct-current motor at a limited voltage lies, at the velocity w, between
//   -stall_effort (1 + w / no_load_velocity) and stall_effort (1 - w / no_load_velocity), and always within `effort`.
//   The velocity is that at the step's beginning. A drive without a loop has the limit of a motor that accelerates.
// - Heat (I²t): a first-order state of the effort's square, thermal_time x' = u² - x, from 0 on. Once it exceeds
//   continuous_effort², the limit is continuous_effort, until x falls below the square of thermal_return of it: a step
//   with hysteresis, as drives switch from peak to continuous current.
// - Dry friction at the velocity v: coulomb + (stiction - coulomb) exp(-(v / stribeck)²), H. Olsson et al., Friction
//   Models and Friction Compensation, European Journal of Control 4 (1998), with the velocity at the step's beginning.
// - Efficiency e: a gear gives e u while the motor drives, and u / e while the load drives the motor. At rest the load
//   moves it only beyond u / e.
// - Backlash: the rotor, with the inertia `armature`, turns freely within the gap. Beyond it, tooth and joint push with
//   contact_stiffness and contact_damping. Both sides are solved together with the joint (implicit Euler), so that any
//   stiffness is stable; an impact of teeth is nearly plastic.
// - Faults change the result.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace rehearse {

struct Joint;

/// A fault of an actuator for a time: from <= t < until.
struct ActuatorFault {
  enum class Kind : std::uint8_t {
    dead,      // it exerts nothing; the joint turns freely
    weak,      // `share` of its effort is left
    locked,    // the joint stays where it is, whatever acts on it
    reversed,  // commands have the other sign
  };
  Kind kind = Kind::dead;
  double share = 1.0;                                      // of `weak`, 0 to 1
  double from = 0.0;                                       // [s]
  double until = std::numeric_limits<double>::infinity();  // [s]
};

struct Actuator {
  /// The share of the continuous effort below which a hot drive gets its peak effort back.
  static constexpr double thermal_return = 0.9;

  double delay = 0.0;                       // [s]
  double jitter = 0.0;                      // at most `delay` [s]
  double quantum = 0.0;                     // commands are whole multiples, in their own unit; 0: any
  std::optional<double> position_gain;      // of the drive's own loop [N·m/rad] or [N/m]
  std::optional<double> velocity_gain;      // [N·m·s/rad] or [N·s/m]
  double period = 0.0;                      // of that loop [s]; 0: every step
  double bandwidth = 0.0;                   // [Hz]; 0: unlimited
  std::optional<double> effort;             // limit [N·m] or [N]; nullopt: that of the model, for drives
  std::optional<double> velocity;           // limit of drives [rad/s] or [m/s]; nullopt: that of the model
  std::optional<double> stall_effort;       // [N·m] or [N]; given together with:
  std::optional<double> no_load_velocity;   // [rad/s] or [m/s]
  std::optional<double> continuous_effort;  // while hot [N·m] or [N]; nullopt: heat limits nothing
  double thermal_time = 0.0;                // [s]; above 0 with a continuous effort
  std::optional<double> armature;           // [kg·m²] or [kg]; nullopt: that of the model
  std::optional<double> damping;            // [N·m·s/rad] or [N·s/m]; nullopt: that of the model
  std::optional<double> coulomb;            // dry friction [N·m] or [N]; nullopt: that of the model
  std::optional<double> stiction;           // dry friction at rest [N·m] or [N]; nullopt: as in motion
  double stribeck = 0.01;                   // [rad/s] or [m/s]
  double efficiency = 1.0;                  // above 0, at most 1
  double backlash = 0.0;                    // width of the gap [rad] or [m]; 0: none
  double contact_stiffness = 1e4;           // of the teeth [N·m/rad] or [N/m]
  double contact_damping = 0.0;             // [N·m·s/rad] or [N·s/m]
  std::uint64_t key = 0;                    // of its random numbers
  std::vector<ActuatorFault> faults = {};   // they act behind all other parts

  bool has_loop() const { return position_gain || velocity_gain; }
  /// Torque-speed line and `effort`.
  bool has_limits() const { return effort || stall_effort; }
};

/// The range of efforts [N·m] or [N].
struct EffortRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// The efforts that an actuator can exert at a velocity [rad/s] or [m/s].
EffortRange effort_range(const Actuator& actuator, double velocity);

/// The joint with limits, rotor, damping and dry friction of its actuator.
Joint joint_with(const Actuator& actuator, Joint joint);

}  // namespace rehearse
