// Forward kinematics along the tree: Body::calcForwardKinematics.
//
// With s the joint axis in world axes and r from the parent's origin to the link's, a rigid parent gives its link
//   v = v_p + w_p x r,  w = w_p,  dv = dv_p + dw_p x r + w_p x (w_p x r),  dw = dw_p
// to which a revolute joint adds    w += s dq,   dw += s ddq + w_p x s dq
// and a prismatic joint             v += s dq,   dv += s ddq + 2 w_p x s dq   (Coriolis).

#include <cnoid/Body>

namespace cnoid {

namespace {

void setPose(Link& link, const Link& parent) {
  link.T() = parent.T() * link.Tb();
  if (link.isRevoluteJoint()) link.T().rotate(AngleAxis(link.q(), link.a()));
  if (link.isPrismaticJoint()) link.T().translate(link.q() * link.d());
}

void setVelocity(Link& link, const Link& parent) {
  const Vector3 axis = parent.R() * (link.Rb() * link.a());
  link.v() = parent.v() + parent.w().cross(link.p() - parent.p());
  link.w() = parent.w();
  if (link.isRevoluteJoint()) link.w() += link.dq() * axis;
  if (link.isPrismaticJoint()) link.v() += link.dq() * axis;
}

void setAcceleration(Link& link, const Link& parent) {
  const Vector3 axis = parent.R() * (link.Rb() * link.a());
  const Vector3 arm = link.p() - parent.p();
  link.dv() = parent.dv() + parent.dw().cross(arm) + parent.w().cross(parent.w().cross(arm));
  link.dw() = parent.dw();
  if (link.isRevoluteJoint()) link.dw() += link.ddq() * axis + link.dq() * parent.w().cross(axis);
  if (link.isPrismaticJoint()) link.dv() += link.ddq() * axis + 2.0 * link.dq() * parent.w().cross(axis);
}

}  // namespace

void Body::calcForwardKinematics(bool calcVelocity, bool calcAcceleration) {
  for (const auto& link : links_) {  // a parent always stands before its children
    if (link->isRoot()) continue;
    setPose(*link, *link->parent());
    if (calcVelocity) setVelocity(*link, *link->parent());
    if (calcVelocity && calcAcceleration) setAcceleration(*link, *link->parent());
  }
}

}  // namespace cnoid
