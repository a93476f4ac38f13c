// Computes one link's pose, velocity and acceleration from its parent's, and the parent's from the link's.
//
// With s the joint axis in world axes and r from the parent's origin to the link's, a rigid parent gives its link
//   v = v_p + w_p x r,  w = w_p,  dv = dv_p + dw_p x r + w_p x (w_p x r),  dw = dw_p
// to which a revolute joint adds    w += s dq,   dw += s ddq + w_p x s dq
// and a prismatic joint             v += s dq,   dv += s ddq + 2 w_p x s dq   (Coriolis).
#pragma once

#include <cnoid/Link>

namespace cnoid {

void setPose(Link& link, const Link& parent);
void setVelocity(Link& link, const Link& parent);
void setAcceleration(Link& link, const Link& parent);

void setPoseOfParent(Link& parent, const Link& link);
/// Call it after setPoseOfParent.
void setVelocityOfParent(Link& parent, const Link& link);
/// Call it after setVelocityOfParent.
void setAccelerationOfParent(Link& parent, const Link& link);

}  // namespace cnoid
