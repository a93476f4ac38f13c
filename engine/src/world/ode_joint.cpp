#include "ode_joint.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "decay.h"
#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;
using std::numbers::pi;

namespace {

/// The effort of a gear's losses as dry friction beside a mean effort, both as shares of the motor's effort u: together
/// they are e u while the motor drives, and u / e while the load drives it. e: the efficiency.
double mean_share(const Actuator& actuator) { return 0.5 * (actuator.efficiency + 1.0 / actuator.efficiency); }
double friction_share(const Actuator& actuator) { return 0.5 * (1.0 / actuator.efficiency - actuator.efficiency); }

/// The share of the velocity at the step's end in the velocity that a damper feels, so that a single joint's velocity
/// falls by exp(-x) in the step. x: damping times time step over inertia. 1/2 for small x, 1 for large x.
double share_of_end(double x) {
  constexpr double small = 0.02;  // below it the next term of the series is less than 1e-8
  if (x < small) return 0.5 + x / 12.0;
  return 1.0 / (1.0 - decay(x)) - 1.0 / x;
}

}  // namespace

OdeJoint::OdeJoint(dWorldID world, const Joint& joint, dBodyID child, dBodyID parent, const Eigen::Isometry3d& frame,
                   KeptLimits kept, const Actuator* actuator)
    : joint_(joint), actuator_(actuator), child_(child), kept_(kept), revolute_(joint.type != JointType::prismatic) {
  const Vector3d anchor = frame.translation();
  const Vector3d axis = frame.linear() * joint.axis;
  if (revolute_) {
    ode_ = dJointCreateHinge(world, nullptr);
    dJointAttach(ode_, child, parent);
    dJointSetHingeAnchor(ode_, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(ode_, axis.x(), axis.y(), axis.z());
  } else {
    ode_ = dJointCreateSlider(world, nullptr);
    dJointAttach(ode_, child, parent);
    dJointSetSliderAxis(ode_, axis.x(), axis.y(), axis.z());
  }
  guide_.emplace(revolute_ ? JointGuide::Type::revolute : JointGuide::Type::prismatic, child, parent, anchor, axis);
  if (actuator && actuator->backlash > 0.0) play_.emplace(*actuator, joint.armature);
  if (resists()) create_resistance(world, parent, axis);
}

/// The joint's own motor is its drive or its dry friction, so damping and spring are a motor of its own about the same
/// axis.
void OdeJoint::create_resistance(dWorldID world, dBodyID parent, const Vector3d& axis) {
  constexpr int in_child = 1;  // the axis moves with the first body
  if (revolute_) {
    resistance_ = dJointCreateAMotor(world, nullptr);
    dJointAttach(resistance_, child_, parent);
    dJointSetAMotorNumAxes(resistance_, 1);
    dJointSetAMotorAxis(resistance_, 0, in_child, axis.x(), axis.y(), axis.z());
  } else {
    resistance_ = dJointCreateLMotor(world, nullptr);
    dJointAttach(resistance_, child_, parent);
    dJointSetLMotorNumAxes(resistance_, 1);
    dJointSetLMotorAxis(resistance_, 0, in_child, axis.x(), axis.y(), axis.z());
  }
  set_resistance(dParamFMax, dInfinity);
}

void OdeJoint::set_resistance(int parameter, double value) {
  if (revolute_)
    dJointSetAMotorParam(resistance_, parameter, value);
  else
    dJointSetLMotorParam(resistance_, parameter, value);
}

// The damper's effort is -d (s v1 + (1 - s) v0), with the velocities v0 before and v1 after the step and the share s of
// share_of_end(). The rotor's is -J (v1 - v0) / dt. The spring's is -k (q0 - r + dt (v1 - v0) / 4), by which a spring
// and a mass keep their energy for every stiffness: the step has determinant 1 and a trace of at most 2. The sum is c
// (v - v1), which is ODE's motor with the velocity v and CFM 1 / c. An effort on a torque-speed line falls by its slope
// as a damper's would. A gear with backlash adds its own c and v while its teeth touch.
void OdeJoint::resist(double inertia, double time_step) {
  const double armature = play_ ? 0.0 : joint_.armature;
  const double rotor = armature / time_step + 0.25 * time_step * joint_.spring_stiffness;
  spring_effort_ = -joint_.spring_stiffness * (displacement() - joint_.spring_reference);
  const double share = share_of_end(joint_.damping * time_step / (inertia + armature));
  resistance_gain_ = share * joint_.damping + rotor;
  double at_rest = (rotor - (1.0 - share) * joint_.damping) * rate() + spring_effort_;
  mean_slope_ = play_ ? 0.0 : share_of_end(slope_ * time_step / (inertia + armature)) * slope_;
  if (mean_slope_ > 0.0) {
    const double gear = actuator_->efficiency < 1.0 ? mean_share(*actuator_) : 1.0;
    resistance_gain_ += gear * mean_slope_;
    at_rest += gear * mean_slope_ * rate();
  }
  if (play_) {
    const double gear = actuator_->efficiency < 1.0 ? mean_share(*actuator_) : 1.0;
    resistance_gain_ += gear * play_->gain();
    at_rest += gear * play_->offset();
  }
  if (resistance_gain_ == 0.0) return;
  resistance_velocity_ = at_rest / resistance_gain_;
  set_resistance(dParamCFM, 1.0 / resistance_gain_);
}

void OdeJoint::turn_rotor(const JointCommand& command, double time_step) {
  if (!play_) return;
  const bool to_place = command.drive & drive_displacement;
  if (!to_place && !(command.drive & drive_velocity))
    return play_->prepare(command.drive & drive_effort ? command.u : 0.0, 0.0, displacement(), rate(), time_step,
                          slope_);
  const double now = play_->begun() ? play_->displacement() : displacement();
  const double velocity =
      to_place ? std::clamp((command.q - now) / time_step, -joint_.velocity, joint_.velocity) : command.dq;
  play_->prepare(std::nullopt, velocity, displacement(), rate(), time_step);
}

/// The largest effort of a drive without a loop of its own.
double OdeJoint::drive_limit() const {
  if (std::isinf(drive_share_)) return drive_share_;
  const double most = std::min(joint_.effort, drive_most_);
  if (!actuator_ || !actuator_->stall_effort) return drive_share_ * most;
  return drive_share_ * std::clamp(effort_range(*actuator_, std::abs(rate())).upper, 0.0, most);
}

/// The largest dry friction in the coming step.
double OdeJoint::dry_friction() const {
  if (!actuator_) return joint_.friction;
  double friction = joint_.friction;
  if (actuator_->stiction) {
    const double velocity = rate() / actuator_->stribeck;
    friction += (*actuator_->stiction - friction) * decay(velocity * velocity);
  }
  if (actuator_->efficiency < 1.0) friction += friction_share(*actuator_) * std::abs(play_ ? play_->effort() : effort_);
  return friction;
}

/// Two motors of different velocities work against each other, and the quick solver balances them slowly. So the
/// resistance is off while a drive without limit moves the joint, and has the velocity of a drive that can overcome it.
/// The effort of damping and rotor at that velocity then changes the drive's limit: it adds to a drive that pushes in
/// its direction, and takes from one that pushes against it. As an effort of its own it would shake the light fingers
/// of a hand: there it is a thousand times the effort that moves a finger, and the solver has small errors of it. The
/// spring's effort is applied. The resistance of a joint that follows stays as it is: the leader feels it.
void OdeJoint::apply_resistance() {
  if (!resistance_) return;
  const bool is_driven = motor_on_ && !joint_.mimic;
  const bool overcome = is_driven && std::isinf(motor_limit_);
  set_resistance(dParamFMax, overcome ? 0.0 : dInfinity);
  if (resistance_feedback_) *resistance_feedback_ = {};  // ODE doesn't write that of a motor that is off
  if (overcome) return;
  if (resistance_gain_ == 0.0) return set_resistance(dParamFMax, 0.0);
  const double effort = is_driven ? resistance_gain_ * (resistance_velocity_ - motor_velocity_) : 0.0;
  const bool drive_is_stronger = is_driven && std::abs(effort) < motor_limit_;
  set_resistance(dParamVel, drive_is_stronger ? motor_velocity_ : resistance_velocity_);
  if (!drive_is_stronger) return;
  const double of_motion = effort - spring_effort_;  // damping and rotor
  const bool in_limit = motor_drives_ && std::abs(of_motion) < motor_limit_;
  const bool helps = of_motion * (motor_velocity_ - rate()) > 0.0;
  if (in_limit) set(dParamFMax, motor_limit_ + (helps ? std::abs(of_motion) : -std::abs(of_motion)));
  applied_ += in_limit ? spring_effort_ : effort;
}

void OdeJoint::set(int parameter, double value) {
  const double bounded = std::isfinite(value) ? value : std::copysign(dInfinity, value);
  if (revolute_)
    dJointSetHingeParam(ode_, parameter, bounded);
  else
    dJointSetSliderParam(ode_, parameter, bounded);
}

double OdeJoint::get(int parameter) const {
  return revolute_ ? dJointGetHingeParam(ode_, parameter) : dJointGetSliderParam(ode_, parameter);
}

double OdeJoint::get_resistance(int parameter) const {
  return revolute_ ? dJointGetAMotorParam(resistance_, parameter) : dJointGetLMotorParam(resistance_, parameter);
}

double OdeJoint::displacement() const {
  return revolute_ ? wrapped_ + 2.0 * pi * turns_ : dJointGetSliderPosition(ode_);
}

// ODE's rate of a slider leaves out that its axis turns.
double OdeJoint::rate_of_bodies() const {
  if (revolute_) return dJointGetHingeAngleRate(ode_);
  if (solved_) return solved_->rate;
  return guide_->rate({BodyMotion::of(child_), BodyMotion::of(dJointGetBody(ode_, 1))});
}

void OdeJoint::before_step(double time_step) {
  previous_rate_ = rate_;
  solved_.reset();
  const dBodyID parent = dJointGetBody(ode_, 1);
  const Vector3d center = vector(dBodyGetPosition(child_));
  const Vector3d at = revolute_ ? anchor() : center;
  axis_ = world_axis();
  arm_ = at - center;
  correction_.setZero();
  Vector3d at_parent = at;
  if (revolute_) {
    dVector3 second;
    dJointGetHingeAnchor2(ode_, second);
    at_parent = vector(second);
    correction_ = dWorldGetERP(dBodyGetWorld(child_)) / time_step * (at_parent - at);
  }
  if (parent) parent_arm_ = at_parent - vector(dBodyGetPosition(parent));
}

// ODE's constraint applies at the poses of the step's beginning: v1 + w1 x a1 - v2 - w2 x a2 = the correction. A
// slider's is free along its axis.
double OdeJoint::missing_impulse() const {
  if (solved_) return 0.0;
  const auto velocity = [](dBodyID body, const Vector3d& arm) -> Vector3d {
    return vector(dBodyGetLinearVel(body)) + vector(dBodyGetAngularVel(body)).cross(arm);
  };
  const dBodyID parent = dJointGetBody(ode_, 1);
  const auto inverse_mass = [](dBodyID body) {
    dMass mass;
    dBodyGetMass(body, &mass);
    return 1.0 / mass.mass;
  };
  Vector3d apart = velocity(child_, arm_) - correction_;
  double inverse = inverse_mass(child_);
  if (parent) {
    apart -= velocity(parent, parent_arm_);
    inverse += inverse_mass(parent);
  }
  if (!revolute_) apart -= axis_.dot(apart) * axis_;
  return apart.norm() / inverse;
}

double OdeJoint::missed_velocity() const {
  constexpr double nearly = 1.0 - 1e-6;  // of the effort limit
  if (solved_ || !motor_on_ || !motor_drives_ || std::abs(motor_effort()) >= nearly * motor_limit_) return 0.0;
  return std::abs(rate_of_bodies() - motor_velocity_);
}

void OdeJoint::begin(double displacement) {
  rate_ = rate_of_bodies();
  if (!revolute_) return;
  wrapped_ = dJointGetHingeAngle(ode_);
  turns_ = static_cast<int>(std::lround((displacement - wrapped_) / (2.0 * pi)));
}

/// ODE compares a hinge's stops with its wrapped angle, and takes none beyond half a turn.
void OdeJoint::set_stops(bool active) {
  if (!kept_.displacement || (!active && !stops_active_)) return;
  const double whole_turns = revolute_ ? 2.0 * pi * turns_ : 0.0;
  set(dParamLoStop, active ? joint_.lower - whole_turns : -dInfinity);
  set(dParamHiStop, active ? joint_.upper - whole_turns : dInfinity);
  stops_active_ = active;
}

/// How far a displacement is beyond the joint's limits: positive above the upper, negative below the lower, else 0.
double OdeJoint::beyond(double displacement) const {
  return displacement - std::clamp(displacement, joint_.lower, joint_.upper);
}

/// A stop pushes a joint that is far beyond it back at most at that velocity, not with ODE's share of the error per
/// step, which for 0.5 rad and 1 ms is 200 rad/s.
void OdeJoint::ease_stops(double time_step) {
  constexpr double velocity = 1.0;  // [rad/s] or [m/s]
  const double share = velocity * time_step / std::max(std::abs(beyond(displacement())), 1e-12);
  const double own = dWorldGetERP(dBodyGetWorld(child_));
  const bool eases = share < own;
  if (!eases && !eases_) return;
  set(dParamStopERP, std::min(share, own));
  eases_ = eases;
}

void OdeJoint::set_motor(double velocity, double limit) {
  if (limit <= 0.0) {
    if (motor_on_) set(dParamFMax, 0.0);
    motor_on_ = false;
    return;
  }
  set(dParamFMax, limit);
  set(dParamVel, velocity);
  motor_on_ = true;
  motor_velocity_ = velocity;
  motor_limit_ = limit;
  read_feedback();
}

void OdeJoint::drive_to(double displacement, double rate, double time_step) {
  const double velocity = rate + (displacement - this->displacement()) / time_step;
  drive_at(std::clamp(velocity, -joint_.velocity, joint_.velocity), time_step);
}

/// A motor beside a stop of ODE gets its whole effort as a torque that the stop has to bear; so ODE's stops are off
/// while a motor drives, and the motor's velocity doesn't move the joint beyond them. If a load has turned the joint
/// beyond a stop, drive and stop together take it back, with whatever effort that needs.
void OdeJoint::drive_at(double velocity, double time_step) {
  set_stops(false);
  const double limit = drive_limit();
  if (!kept_.displacement) return set_motor(velocity, limit);
  constexpr double slack = 1e-4, back = 1.0;  // [rad] or [m], [rad/s] or [m/s]
  const double now = displacement();
  const double over = beyond(now);
  if (std::abs(over) > slack)
    return set_motor(-std::copysign(std::min(std::abs(over) / time_step, back), over), unlimited);
  set_motor(std::clamp(velocity, std::min((joint_.lower - now) / time_step, 0.0),
                       std::max((joint_.upper - now) / time_step, 0.0)),
            limit);
}

void OdeJoint::drive(const JointCommand& command, double time_step) {
  REHEARSE_ASSERT(std::isfinite(command.q) && std::isfinite(command.dq) && std::isfinite(command.u),
                  "commands are finite when they reach the world");
  applied_ = 0.0;
  previous_effort_ = std::exchange(effort_, 0.0);
  const auto drive = play_ ? std::uint8_t{drive_none} : command.drive;
  // displacement before velocity before effort, as in Choreonoid's MuJoCo item
  if (drive & drive_displacement) {
    drive_to(command.q, 0.0, time_step);
  } else if (drive & drive_velocity) {
    drive_at(command.dq, time_step);
  } else {
    set_stops(true);
    const bool at_stop = stops_active_ && (displacement() <= joint_.lower || displacement() >= joint_.upper);
    if (drive & drive_effort) effort_ = kept_.effort ? std::clamp(command.u, -joint_.effort, joint_.effort) : command.u;
    set_motor(0.0, at_stop ? 0.0 : dry_friction());  // see drive_at()
    applied_ = actuator_ && actuator_->efficiency < 1.0 ? mean_share(*actuator_) * effort_ : effort_;
  }
  motor_drives_ = (drive & (drive_displacement | drive_velocity)) != 0;
  apply_effort(time_step);
}

void OdeJoint::follow(const OdeJoint& leader, double time_step) {
  const Mimic& mimic = *joint_.mimic;
  applied_ = 0.0;
  previous_effort_ = std::exchange(effort_, 0.0);
  drive_to(mimic.multiplier * leader.displacement() + mimic.offset, mimic.multiplier * leader.rate(), time_step);
  motor_drives_ = true;
  apply_effort(time_step);
}

void OdeJoint::apply_effort(double time_step) {
  if (stops_active_) ease_stops(time_step);
  apply_resistance();
  even_torque_.setZero();
  if (applied_ == 0.0) return;
  if (revolute_) {
    dJointAddHingeTorque(ode_, applied_);
    return;
  }
  // ODE applies the force at the two centres of mass, and compensates the couple by half of it on each body
  if (const dBodyID parent = dJointGetBody(ode_, 1)) {
    const Vector3d half = 0.5 * (vector(dBodyGetPosition(parent)) - vector(dBodyGetPosition(child_)));
    even_torque_ = half.cross(applied_ * world_axis());
  }
  dJointAddSliderForce(ode_, applied_);
}

void OdeJoint::after_step(double time_step) {
  rate_ = rate_of_bodies();
  acceleration_ = (rate_ - previous_rate_) / time_step;
  effort_ -= mean_slope_ * (rate_ - previous_rate_);
  if (play_) {
    play_->finish(rate_, time_step);
    effort_ = play_->effort();
  }
  if (motor_drives_) effort_ = motor_effort();
  if (motor_drives_ && motor_limit_ > joint_.effort)  // the rest is that of the stop
    effort_ = std::clamp(effort_, -joint_.effort, joint_.effort);
  if (!revolute_) return;
  const double angle = dJointGetHingeAngle(ode_);
  if (angle - wrapped_ > pi) --turns_;
  if (angle - wrapped_ < -pi) ++turns_;
  wrapped_ = angle;
}

bool OdeJoint::is_resisted() const { return resistance_ && get_resistance(dParamFMax) > 0.0; }

void OdeJoint::read_feedback() {
  if (feedback_) return;
  feedback_ = std::make_unique<dJointFeedback>();
  dJointSetFeedback(ode_, feedback_.get());
  if (!resistance_) return;
  resistance_feedback_ = std::make_unique<dJointFeedback>();
  dJointSetFeedback(resistance_, resistance_feedback_.get());
}

Vector3d OdeJoint::world_axis() const {
  dVector3 axis;
  if (revolute_)
    dJointGetHingeAxis(ode_, axis);
  else
    dJointGetSliderAxis(ode_, axis);
  return vector(axis);
}

Vector3d OdeJoint::anchor() const {
  dVector3 anchor;
  dJointGetHingeAnchor(ode_, anchor);
  return vector(anchor);
}

Wrench OdeJoint::child_wrench() const {
  // ODE reports the joint's constraint forces on body 1, the child. They don't include efforts that were added as
  // external forces.
  Wrench wrench{vector(feedback_->f1), vector(feedback_->t1)};
  (revolute_ ? wrench.torque : wrench.force) += applied_ * axis_;
  if (!revolute_) wrench.torque += even_torque_;
  if (resistance_) {
    wrench.force += vector(resistance_feedback_->f1);
    wrench.torque += vector(resistance_feedback_->t1);
  }
  return wrench;
}

double OdeJoint::motor_effort() const {
  const auto along = [&](const dJointFeedback& feedback) {
    return axis_.dot(vector(revolute_ ? feedback.t1 : feedback.f1));
  };
  double effort = 0.0, of_resistance = 0.0;
  if (solved_) {
    effort = solved_->effort;
    if (is_resisted()) of_resistance = resistance_gain_ * (get_resistance(dParamVel) - solved_->rate);
  } else {
    effort = along(*feedback_);
    // about the hinge's axis, where the guiding constraint forces have no component
    if (revolute_) effort -= axis_.dot(arm_.cross(vector(feedback_->f1)));
    if (resistance_) of_resistance = along(*resistance_feedback_);
  }
  if (!resistance_) return effort;
  // the effort of everything that acts on the joint, except the resistance
  return effort + applied_ + of_resistance - resistance_gain_ * (resistance_velocity_ - rate_of_bodies());
}

}  // namespace rehearse
