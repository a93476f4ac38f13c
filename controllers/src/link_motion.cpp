#include "link_motion.h"

namespace cnoid {

namespace {

/// The joint's axis in world axes. A revolute joint's axis is the same before and after its turn.
Vector3 axisInWorld(const Link& link, const Link& parent) { return parent.R() * (link.Rb() * link.a()); }

/// Pose of the link in its parent's frame.
Isometry3 poseInParent(const Link& link) {
  Isometry3 pose = link.Tb();
  if (link.isRevoluteJoint()) pose.rotate(AngleAxis(link.q(), link.a()));
  if (link.isPrismaticJoint()) pose.translate(link.q() * link.d());
  return pose;
}

}  // namespace

void setPose(Link& link, const Link& parent) {
  link.T() = parent.T() * link.Tb();
  if (link.isRevoluteJoint()) link.T().rotate(AngleAxis(link.q(), link.a()));
  if (link.isPrismaticJoint()) link.T().translate(link.q() * link.d());
}

void setVelocity(Link& link, const Link& parent) {
  const Vector3 axis = axisInWorld(link, parent);
  link.v() = parent.v() + parent.w().cross(link.p() - parent.p());
  link.w() = parent.w();
  if (link.isRevoluteJoint()) link.w() += link.dq() * axis;
  if (link.isPrismaticJoint()) link.v() += link.dq() * axis;
}

void setAcceleration(Link& link, const Link& parent) {
  const Vector3 axis = axisInWorld(link, parent);
  const Vector3 arm = link.p() - parent.p();
  link.dv() = parent.dv() + parent.dw().cross(arm) + parent.w().cross(parent.w().cross(arm));
  link.dw() = parent.dw();
  if (link.isRevoluteJoint()) link.dw() += link.ddq() * axis + link.dq() * parent.w().cross(axis);
  if (link.isPrismaticJoint()) link.dv() += link.ddq() * axis + 2.0 * link.dq() * parent.w().cross(axis);
}

void setPoseOfParent(Link& parent, const Link& link) { parent.T() = link.T() * poseInParent(link).inverse(); }

void setVelocityOfParent(Link& parent, const Link& link) {
  const Vector3 axis = axisInWorld(link, parent);
  parent.w() = link.w();
  if (link.isRevoluteJoint()) parent.w() -= link.dq() * axis;
  parent.v() = link.v() - parent.w().cross(link.p() - parent.p());
  if (link.isPrismaticJoint()) parent.v() -= link.dq() * axis;
}

void setAccelerationOfParent(Link& parent, const Link& link) {
  const Vector3 axis = axisInWorld(link, parent);
  const Vector3 arm = link.p() - parent.p();
  parent.dw() = link.dw();
  if (link.isRevoluteJoint()) parent.dw() -= link.ddq() * axis + link.dq() * parent.w().cross(axis);
  parent.dv() = link.dv() - parent.dw().cross(arm) - parent.w().cross(parent.w().cross(arm));
  if (link.isPrismaticJoint()) parent.dv() -= link.ddq() * axis + 2.0 * link.dq() * parent.w().cross(axis);
}

}  // namespace cnoid
