// What a joint states for the direct solver, and takes from it.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ode_joint.h"

namespace rehearse {

void OdeJoint::describe(const StepLaw& law, const JointBodies& bodies, TreeBody& body) const {
  body.joint = guide_->motion(law, bodies);
  if (is_resisted()) {
    body.gain = resistance_gain_ * law.time_step;
    body.offset = body.gain * get_resistance(dParamVel);
  }
  if (motor_on_ && !joint_.mimic && std::isinf(get(dParamFMax))) body.drive = {motor_velocity_, law.softness};
}

// A drive that was at its limit, or a joint that was turning against its friction, is assumed to be still.
std::optional<LimitedDrive> OdeJoint::limited_drive(const StepLaw& law) const {
  if (!motor_on_ || joint_.mimic || std::isinf(get(dParamFMax))) return std::nullopt;
  constexpr double nearly = 1.0 - 1e-9, at_rest = 1e-9;  // share of the limit; [rad/s] or [m/s]
  LimitedDrive drive;
  drive.drive = {motor_velocity_, law.softness};
  drive.limit = get(dParamFMax) * law.time_step;
  const double rate = previous_rate_;
  const bool at_upper = motor_drives_ ? previous_effort_ >= nearly * motor_limit_ : rate < -at_rest;
  const bool at_lower = motor_drives_ ? previous_effort_ <= -nearly * motor_limit_ : rate > at_rest;
  if (at_upper) drive.state = LimitedDrive::State::at_upper;
  if (at_lower) drive.state = LimitedDrive::State::at_lower;
  return drive;
}

// The joint comes to its stop in one step and no farther. From beyond it returns by a share of the way in each step.
std::optional<Stop> OdeJoint::stops(const StepLaw& law) const {
  if (!kept_.displacement) return std::nullopt;
  constexpr double fastest = 1.0;  // [rad/s] or [m/s]
  const double now = displacement(), over = beyond(now);
  const double back = std::clamp(-law.correction_rate * over, -fastest, fastest);
  Stop stop;
  stop.softness = law.softness;
  stop.corrects = over != 0.0;
  stop.lowest = over < 0.0 ? back : (joint_.lower - now) / law.time_step;
  stop.highest = over > 0.0 ? back : (joint_.upper - now) / law.time_step;
  const double rate = previous_rate_;
  if (joint_.lower >= joint_.upper) {
    stop.state = Stop::State::locked;
    stop.lowest = stop.highest = back;
  } else if (!motor_drives_ && (over > 0.0 || rate >= stop.highest)) {
    stop.state = Stop::State::at_upper;
  } else if (!motor_drives_ && (over < 0.0 || rate <= stop.lowest)) {
    stop.state = Stop::State::at_lower;
  }
  return stop;
}

JointRow OdeJoint::coupling(const StepLaw& law, const OdeJoint& leader) const {
  constexpr double fastest = 1.0;  // [rad/s] or [m/s], of a joint that isn't at its place
  const Mimic& mimic = *joint_.mimic;
  const double error = displacement() - mimic.multiplier * leader.displacement() - mimic.offset;
  JointRow row;
  row.factor = -mimic.multiplier;
  row.target = std::clamp(-law.correction_rate * error, -fastest, fastest);
  if (std::isfinite(motor_limit_)) row.bounds = {-motor_limit_ * law.time_step, motor_limit_ * law.time_step, -1};
  return row;
}

/// By which the drive or the leader turns the joint in the step.
double OdeJoint::turn_of(double time_step) const {
  return time_step * (joint_.mimic && solved_ ? solved_->rate : motor_velocity_);
}

bool OdeJoint::turns_far(double time_step) const {
  constexpr double large = 0.1, half_turn = std::numbers::pi;  // [rad]; ODE doesn't count the turns of a step
  if (!revolute_ || !motor_on_) return false;
  const double turn = std::abs(turn_of(time_step));
  return turn >= large && turn < half_turn && !std::isfinite(get(dParamFMax));
}

std::optional<BodyPose> OdeJoint::driven_pose(const BodyPose& parent, double time_step) const {
  if (!turns_far(time_step)) return std::nullopt;
  return guide_->first_at(displacement() + turn_of(time_step), parent);  // from the beginning of the step
}

/// What ODE reports of the joint and of its resistance is their sum here.
void OdeJoint::take_wrench(const Vector6d& wrench) {
  std::copy(wrench.data(), wrench.data() + 3, feedback_->f1);
  std::copy(wrench.data() + 3, wrench.data() + 6, feedback_->t1);
  if (resistance_feedback_) *resistance_feedback_ = {};
}

}  // namespace rehearse
