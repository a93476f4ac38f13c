#include "actuator_stage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/chance.h"
#include "decay.h"
#include "model/acting_faults.h"

namespace rehearse {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::uint8_t motion_drives = drive_displacement | drive_velocity;
constexpr double rounding = 1e-9;  // [steps]: 6 ms are 6 steps of 1 ms, whatever their quotient rounds to

/// Steps in a time; a number that rounding separates from a whole one is that one.
double steps_in(double time, double time_step) {
  const double steps = time / time_step, whole = std::round(steps);
  return std::abs(steps - whole) < rounding * std::max(1.0, whole) ? whole : steps;
}

/// The time step over the time constant.
double pace_of(double bandwidth, double time_step) { return 2.0 * std::numbers::pi * bandwidth * time_step; }

/// (1 - exp(-x)) / x.
double mean_decay(double x) {
  constexpr double small = 1e-4;  // below it the next term of the series is less than 1e-12
  return x < small ? 1.0 - x / 2.0 + x * x / 6.0 : (1.0 - decay(x)) / x;
}

}  // namespace

ActuatorStage::ActuatorStage(const Actuator& actuator, double start, double time_step)
    : actuator_(actuator),
      time_step_(time_step),
      delay_(steps_in(actuator.delay, time_step)),
      lag_(decay(pace_of(actuator.bandwidth, time_step))),
      mean_lag_(mean_decay(pace_of(actuator.bandwidth, time_step))),
      cooling_(actuator.continuous_effort ? decay(time_step / actuator.thermal_time) : 0.0) {
  const double longest = std::ceil(steps_in(actuator.delay + actuator.jitter, time_step));
  written_.assign(static_cast<std::size_t>(longest) + 1, {drive_none, start, 0.0, 0.0});
}

JointCommand ActuatorStage::act(const JointCommand& written, const JointReading& joint) {
  // a drive without a loop has exerted what its motion needed, and a joint that is locked is held by another part
  if (actuator_.continuous_effort) heat(drives_effort_ != 0.0 ? effort_ : locked_ != 0.0 ? 0.0 : joint.u);
  const JointCommand acting = pass(written, joint.q, joint.dq);
  return actuator_.faults.empty() ? acting : under_faults(acting, joint.q);
}

/// With the effort of the last step, which is constant: the exact solution of the lag.
void ActuatorStage::heat(double effort) {
  const double square = effort * effort;
  heat_ = square + cooling_ * (heat_ - square);
  const double budget = *actuator_.continuous_effort * *actuator_.continuous_effort;
  constexpr double returns = Actuator::thermal_return * Actuator::thermal_return;
  if (heat_ > budget) hot_ = 1.0;
  if (heat_ < returns * budget) hot_ = 0.0;
}

double ActuatorStage::thermal_limit() const {
  return hot_ != 0.0 ? *actuator_.continuous_effort : std::numeric_limits<double>::infinity();
}

JointCommand ActuatorStage::pass(const JointCommand& written, double q, double dq) {
  const auto index = static_cast<std::size_t>(steps_) % written_.size();
  if (steps_ == 0)
    for (JointCommand& at_rest : written_) at_rest.drive = written.drive;
  written_[index] = rounded(written);
  JointCommand acting = in_force();
  if (actuator_.has_loop() && (acting.drive & motion_drives)) {
    acting.u = loop_effort(acting, q, dq);
    acting.drive = drive_effort;
  }
  ++steps_;
  drives_effort_ = wanted_ = effort_ = slope_ = 0.0;
  if (acting.drive & motion_drives) return acting;
  drives_effort_ = 1.0;
  wanted_ = lagged(acting.drive & drive_effort ? acting.u : 0.0);
  const EffortRange range = effort_range(actuator_, dq);
  const double limited = std::clamp(wanted_, range.lower, range.upper);
  acting.u = effort_ = hot_ != 0.0 ? std::clamp(limited, -thermal_limit(), thermal_limit()) : limited;
  const bool on_line = actuator_.stall_effort && actuator_.no_load_velocity && effort_ != wanted_ &&
                       std::abs(effort_) < std::min(actuator_.effort.value_or(infinite), thermal_limit());
  if (on_line) slope_ = *actuator_.stall_effort / *actuator_.no_load_velocity;
  acting.drive |= drive_effort;
  return acting;
}

/// The command of a step that pass() has counted.
JointCommand ActuatorStage::under_faults(const JointCommand& acting, double q) {
  const double now = static_cast<double>(steps_ - 1) * time_step_;
  const FaultedCommand faulted = rehearse::under_faults(actuator_.faults, acting, now, time_step_);
  wanted_ *= faulted.factor;
  effort_ *= faulted.factor;
  slope_ *= faulted.factor;
  drive_share_ = faulted.drive_share;
  if (faulted.is_locked && locked_ == 0.0) locked_at_ = q;
  locked_ = faulted.is_locked ? 1.0 : 0.0;
  if (!faulted.is_locked) return faulted.command;
  drive_share_ = std::numeric_limits<double>::infinity();
  drives_effort_ = wanted_ = effort_ = slope_ = 0.0;
  return {drive_displacement, locked_at_, 0.0, 0.0};
}

/// Rounds the quantities that the command contains.
JointCommand ActuatorStage::rounded(JointCommand command) const {
  if (actuator_.quantum <= 0.0) return command;
  const auto round = [this](double& number) {
    const double multiple = std::round(number / actuator_.quantum) * actuator_.quantum;
    if (std::isfinite(multiple)) number = multiple;
  };
  if (command.drive & drive_displacement) round(command.q);
  if (command.drive & drive_velocity) round(command.dq);
  if (command.drive & drive_effort) round(command.u);
  return command;
}

/// Of the command that was written in that step [steps].
double ActuatorStage::delay_of(std::int64_t step) const {
  if (actuator_.jitter <= 0.0) return delay_;
  const double random = 2.0 * Chance(actuator_.key, step).uniform(0) - 1.0;
  return std::max(0.0, (actuator_.delay + actuator_.jitter * random) / time_step_);
}

/// The mean of the commands in force in the coming step, with the drive of the newest. A command is in force from its
/// arrival until a newer one arrives.
JointCommand ActuatorStage::in_force() {
  if (written_.size() == 1) return written_.front();
  JointCommand mean{drive_none, 0.0, 0.0, 0.0};
  double until = 1.0;  // of the step
  bool is_newest = true;
  const auto size = static_cast<std::int64_t>(written_.size());
  const std::int64_t newest = steps_ % size;
  // without jitter those that are newer haven't arrived
  const std::int64_t first = actuator_.jitter > 0.0 ? 0 : std::min(static_cast<std::int64_t>(delay_), size - 1);
  for (std::int64_t age = first; age < size && until > 0.0; ++age) {
    const bool is_oldest = age + 1 == size;
    const double arrival = delay_of(steps_ - age) - static_cast<double>(age);
    if (arrival >= until && !is_oldest) continue;
    const double from = is_oldest ? 0.0 : std::max(arrival, 0.0);
    const JointCommand& command = written_[static_cast<std::size_t>(newest < age ? newest - age + size : newest - age)];
    const double share = until - from;
    if (share == 1.0) return command;
    if (std::exchange(is_newest, false)) mean.drive = command.drive;
    mean.q += share * command.q;
    mean.dq += share * command.dq;
    mean.u += share * command.u;
    until = from;
  }
  return mean;
}

double ActuatorStage::loop_effort(const JointCommand& wanted, double q, double dq) {
  const auto period_of = [this](std::int64_t step) {
    return std::floor(static_cast<double>(step) * time_step_ / actuator_.period + rounding);
  };
  const bool is_due = steps_ == 0 || actuator_.period <= time_step_ || period_of(steps_) != period_of(steps_ - 1);
  if (!is_due) return held_;
  const double limit = actuator_.velocity.value_or(std::numeric_limits<double>::infinity());
  const double rate = wanted.drive & drive_velocity ? std::clamp(wanted.dq, -limit, limit) : 0.0;
  held_ = actuator_.velocity_gain.value_or(0.0) * (rate - dq);
  if (wanted.drive & drive_displacement) held_ += actuator_.position_gain.value_or(0.0) * (wanted.q - q);
  if (wanted.drive & drive_effort) held_ += wanted.u;
  return held_;
}

/// The mean effort of the coming step.
double ActuatorStage::lagged(double effort) {
  if (actuator_.bandwidth <= 0.0) return effort;
  const double difference = lagged_ - effort;
  lagged_ = effort + lag_ * difference;
  return effort + mean_lag_ * difference;
}

void ActuatorStage::visit_state(StateVisitor& visitor) {
  visitor.visit(&steps_, sizeof steps_);
  for (double* number : {&held_, &lagged_, &drives_effort_, &wanted_, &effort_}) visitor.visit(*number);
  const auto size = static_cast<std::int64_t>(written_.size());
  for (std::int64_t age = 1; age <= size; ++age) {  // from the newest on: a longer delay takes what a shorter one has
    JointCommand& command = written_[static_cast<std::size_t>(((steps_ - age) % size + size) % size)];
    double drive = command.drive;
    visitor.visit(drive);
    command.drive = static_cast<std::uint8_t>(drive);
    visitor.visit(command.q);
    visitor.visit(command.dq);
    visitor.visit(command.u);
  }
}

void ActuatorStage::visit_lock(StateVisitor& visitor) {
  if (actuator_.faults.empty()) return;
  for (double* number : {&locked_, &locked_at_}) visitor.visit(*number);
}

void ActuatorStage::visit_heat(StateVisitor& visitor) {
  if (!actuator_.continuous_effort) return;
  for (double* number : {&heat_, &hot_}) visitor.visit(*number);
}

}  // namespace rehearse
