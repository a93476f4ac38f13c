// Jacobians: matrices that map the velocities of joints to velocities of links, of the centre of mass, and to momentum.
//
// All are in world axes, and use the links' T(): call Body::calcForwardKinematics() first.
#pragma once

#include "Body.h"
#include "JointPath.h"

namespace cnoid {

/// Velocity of the centre of mass. Columns: the joints by id, for a base link that doesn't move. Without a base link
/// (null) the root link doesn't move, and six columns follow: velocity of the root link's origin, then its angular
/// velocity. Throws std::invalid_argument for a link of another body.
CNOID_GENERAL_EXPORT void calcCMJacobian(Body* body, Link* base, MatrixXd& J);

/// Angular momentum, 3 rows, columns as above. Without a base link it is about the centre of mass; with one, about the
/// world's origin.
CNOID_GENERAL_EXPORT void calcAngularMomentumJacobian(Body* body, Link* base, MatrixXd& H);

/// One column of a link's Jacobian: velocity of `point`, which is fixed to the link and given in the world [m], then
/// angular velocity, for the joint of this number in the path. Zero if the joint doesn't move the link.
CNOID_GENERAL_EXPORT Vector6 jacobianColumn(const JointPath& path, int joint, const Link* targetLink,
                                            const Vector3& point);

/// Writes rows of the Jacobian of a link relative to the path's base link into `out_J`, whose size is not changed.
/// Columns: the joints of the path, from `colOffset` on. Rows from `rowOffset` on: those of x, y, z of the velocity
/// (bits 0x1, 0x2, 0x4 of the mask) and of the angular velocity (0x8, 0x10, 0x20). The velocity is that of the link's
/// origin or, if `useTargetLinkLocalPos`, of a point in the link's frame.
template <int elementMask, int rowOffset, int colOffset, bool useTargetLinkLocalPos>
void setJacobian(const JointPath& path, Link* targetLink, const Vector3& targetLinkLocalPos, MatrixXd& out_J) {
  static_assert(elementMask > 0 && elementMask <= 0x3f, "the mask selects some of the six rows of a Jacobian");
  static_assert(rowOffset >= 0 && colOffset >= 0, "an offset is not negative");
  const Vector3 point =
      useTargetLinkLocalPos ? Vector3(targetLink->T() * targetLinkLocalPos) : Vector3(targetLink->p());
  for (int i = 0; i < path.numJoints(); ++i) {
    const Vector6 column = jacobianColumn(path, i, targetLink, point);
    int row = rowOffset;
    for (int element = 0; element < 6; ++element) {
      if (elementMask & (1 << element)) out_J(row++, i + colOffset) = column[element];
    }
  }
}
template <int elementMask, int rowOffset, int colOffset>
void setJacobian(const JointPath& path, Link* targetLink, MatrixXd& out_J) {
  setJacobian<elementMask, rowOffset, colOffset, false>(path, targetLink, Vector3::Zero(), out_J);
}

}  // namespace cnoid
