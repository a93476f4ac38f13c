// ActuatorStage: the explicit parts of an actuator, between the command of a joint and the world: quantum, delay, the
// drive's own loop, bandwidth, limits of the effort and heat. Private to the world library.
#pragma once

#include <rehearse/actuator.h>
#include <rehearse/io.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulated_body.h"

namespace rehearse {

class ActuatorStage {
 public:
  /// `actuator` must outlive this. `start`: initial displacement of the joint [rad] or [m]. `time_step` [s].
  ActuatorStage(const Actuator& actuator, double start, double time_step);

  /// The command that acts in the coming step: `joint` is its reading at the step's beginning.
  /// Must be called once a step.
  JointCommand act(const JointCommand& written, const JointReading& joint);

  /// The share of its effort limit that faults leave a drive without a loop in this step; infinity: no limit.
  double drive_share() const { return drive_share_; }
  /// The largest effort that its heat allows in this step; infinity: it isn't hot [N·m] or [N].
  double thermal_limit() const;
  /// By which that effort falls with the velocity in this step: on a torque-speed line [N·m·s] or [N·s/m].
  double slope() const { return slope_; }
  /// The mean of the effort in the step, with its slope.
  void take_effort(double effort) {
    if (slope_ > 0.0) effort_ = effort;
  }
  /// Whether the last step's command was an effort, that of the drive's own loop included.
  bool drives_effort() const { return drives_effort_ != 0.0; }
  /// That effort before its limits, and after them [N·m] or [N].
  double wanted() const { return wanted_; }
  double effort() const { return effort_; }

  void visit_state(StateVisitor& visitor);
  /// Of what only some actuators have.
  void visit_lock(StateVisitor& visitor);
  void visit_heat(StateVisitor& visitor);

 private:
  JointCommand rounded(JointCommand command) const;
  double delay_of(std::int64_t step) const;
  JointCommand in_force();
  double loop_effort(const JointCommand& wanted, double q, double dq);
  double lagged(double effort);
  void heat(double effort);
  JointCommand pass(const JointCommand& written, double q, double dq);
  JointCommand under_faults(const JointCommand& acting, double q);

  const Actuator& actuator_;
  const double time_step_;
  const double delay_;           // without jitter [steps]
  const double lag_, mean_lag_;  // shares of the effort before the step at its end, and in its mean
  const double cooling_;         // share of the heat before the step at its end
  // state
  std::int64_t steps_ = 0;             // made so far
  std::vector<JointCommand> written_;  // by step modulo its size
  double held_ = 0.0;                  // effort of the drive's own loop
  double lagged_ = 0.0;                // effort behind the bandwidth, at the step's beginning
  double drives_effort_ = 0.0;         // 1: true
  double wanted_ = 0.0;
  double effort_ = 0.0;
  double locked_ = 0.0;     // 1: a fault locks the joint
  double locked_at_ = 0.0;  // its displacement then
  double heat_ = 0.0;       // mean square of the effort
  double hot_ = 0.0;        // 1: its effort is limited to the continuous one
  // not part of the state: each step determines them
  double drive_share_ = 1.0;
  double slope_ = 0.0;
};

}  // namespace rehearse
