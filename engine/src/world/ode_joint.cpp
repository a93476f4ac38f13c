#include "ode_joint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;
using std::numbers::pi;

OdeJoint::OdeJoint(dWorldID world, const Joint& joint, const JointEnd& child, dBodyID parent,
                   const Eigen::Isometry3d& frame, KeptLimits kept)
    : joint_(joint), child_(child), kept_(kept), revolute_(joint.type != JointType::prismatic) {
  const Vector3d anchor = frame.translation();
  const Vector3d axis = frame.linear() * joint.axis;
  if (revolute_) {
    ode_ = dJointCreateHinge(world, nullptr);
    dJointAttach(ode_, child.body, parent);
    dJointSetHingeAnchor(ode_, anchor.x(), anchor.y(), anchor.z());
    dJointSetHingeAxis(ode_, axis.x(), axis.y(), axis.z());
  } else {
    ode_ = dJointCreateSlider(world, nullptr);
    dJointAttach(ode_, child.body, parent);
    dJointSetSliderAxis(ode_, axis.x(), axis.y(), axis.z());
  }
  if (kept_.displacement) {
    far_stops_ = revolute_ && (joint.lower < -pi || joint.upper > pi);
    set_stops();
  }
}

void OdeJoint::set(int parameter, double value) {
  const double bounded = std::isfinite(value) ? value : std::copysign(dInfinity, value);
  if (revolute_)
    dJointSetHingeParam(ode_, parameter, bounded);
  else
    dJointSetSliderParam(ode_, parameter, bounded);
}

double OdeJoint::displacement() const {
  return revolute_ ? wrapped_ + 2.0 * pi * turns_ : dJointGetSliderPosition(ode_);
}

double OdeJoint::rate() const { return revolute_ ? dJointGetHingeAngleRate(ode_) : dJointGetSliderPositionRate(ode_); }

void OdeJoint::count_turns(double displacement) {
  if (!revolute_) return;
  wrapped_ = dJointGetHingeAngle(ode_);
  turns_ = static_cast<int>(std::lround((displacement - wrapped_) / (2.0 * pi)));
}

/// ODE compares a hinge's stops with its wrapped angle.
void OdeJoint::set_stops() {
  const double whole_turns = revolute_ ? 2.0 * pi * turns_ : 0.0;
  set(dParamLoStop, joint_.lower - whole_turns);
  set(dParamHiStop, joint_.upper - whole_turns);
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
  measure_wrench();
}

void OdeJoint::drive_to(double displacement, double rate, double time_step) {
  const double velocity = rate + (displacement - this->displacement()) / time_step;
  set_motor(std::clamp(velocity, -joint_.velocity, joint_.velocity), joint_.effort);
}

double OdeJoint::damping_effort() const { return joint_.damping > 0.0 ? -joint_.damping * rate() : 0.0; }

void OdeJoint::drive(const JointCommand& command, double time_step) {
  REHEARSE_ASSERT(std::isfinite(command.q) && std::isfinite(command.dq) && std::isfinite(command.u),
                  "commands are finite when they reach the world");
  applied_ = damping_effort();
  effort_ = 0.0;
  // displacement before velocity before effort, as in Choreonoid's MuJoCo item
  if (command.drive & drive_displacement) {
    drive_to(command.q, 0.0, time_step);
  } else if (command.drive & drive_velocity) {
    set_motor(command.dq, joint_.effort);
  } else {
    set_motor(0.0, joint_.friction);
    if (command.drive & drive_effort)
      effort_ = kept_.effort ? std::clamp(command.u, -joint_.effort, joint_.effort) : command.u;
    applied_ += effort_;
  }
  motor_drives_ = (command.drive & (drive_displacement | drive_velocity)) != 0;
  apply_effort();
}

void OdeJoint::follow(const OdeJoint& leader, double time_step) {
  const Mimic& mimic = *joint_.mimic;
  applied_ = damping_effort();
  effort_ = 0.0;
  drive_to(mimic.multiplier * leader.displacement() + mimic.offset, mimic.multiplier * leader.rate(), time_step);
  motor_drives_ = true;
  apply_effort();
}

void OdeJoint::apply_effort() {
  if (far_stops_) set_stops();
  even_torque_.setZero();
  if (applied_ == 0.0) return;
  if (revolute_) {
    dJointAddHingeTorque(ode_, applied_);
    return;
  }
  // ODE applies the force at the two centres of mass, and compensates the couple by half of it on each body
  if (const dBodyID parent = dJointGetBody(ode_, 1)) {
    const Vector3d half = 0.5 * (vector(dBodyGetPosition(parent)) - vector(dBodyGetPosition(child_.body)));
    even_torque_ = half.cross(applied_ * world_axis());
  }
  dJointAddSliderForce(ode_, applied_);
}

void OdeJoint::after_step(double time_step) {
  acceleration_ = (rate() - previous_rate_) / time_step;
  if (motor_drives_) effort_ = motor_effort();
  if (!revolute_) return;
  const double angle = dJointGetHingeAngle(ode_);
  if (angle - wrapped_ > pi) --turns_;
  if (angle - wrapped_ < -pi) ++turns_;
  wrapped_ = angle;
}

void OdeJoint::measure_wrench() {
  if (feedback_) return;
  feedback_ = std::make_unique<dJointFeedback>();
  dJointSetFeedback(ode_, feedback_.get());
}

Vector3d OdeJoint::world_axis() const {
  dVector3 axis;
  if (revolute_)
    dJointGetHingeAxis(ode_, axis);
  else
    dJointGetSliderAxis(ode_, axis);
  return vector(axis);
}

Wrench OdeJoint::child_wrench() const {
  // ODE reports the joint's constraint forces on body 1, the child. They don't include efforts that were added as
  // external forces.
  Wrench wrench{vector(feedback_->f1), vector(feedback_->t1)};
  (revolute_ ? wrench.torque : wrench.force) += applied_ * world_axis();
  if (!revolute_) wrench.torque += even_torque_;
  return wrench;
}

double OdeJoint::motor_effort() const {
  const Vector3d force = vector(feedback_->f1);
  if (!revolute_) return world_axis().dot(force);
  // about the hinge's axis, where the guiding constraint forces have no component
  const Vector3d lever = rotation(dBodyGetRotation(child_.body)) * child_.center;
  return world_axis().dot(vector(feedback_->t1) + lever.cross(force));
}

void OdeJoint::visit_turns(StateVisitor& visitor) {
  visitor.visit(&turns_, sizeof turns_);
  visitor.visit(wrapped_);
}

}  // namespace rehearse
