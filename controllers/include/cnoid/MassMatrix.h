// The equation of motion of a body:
//
//       | dv  |         | force on the root link                     |
//   M * | dw  |  + b =  | torque on the root link, about its origin  |
//       | ddq |         | u                                          |
//
// in world axes; dv and dw are of the root link's origin. The rows of the root are absent if it is fixed. Joints are
// ordered by id; the rows and columns of an id without a joint are zero, apart from its rotor inertia.
#pragma once

#include "Body.h"

namespace cnoid {

/// M, from the links' T(): call Body::calcForwardKinematics() first. Rotor inertia is part of it. Writes nothing to the
/// body.
CNOID_GENERAL_EXPORT void calcMassMatrix(Body* body, MatrixXd& out_M);

/// M and b. `g`: the opposite of the acceleration of gravity, (0, 0, 9.80665) [m/s²]. b contains gravity, velocities,
/// external forces (F_ext), and ddq of joints without an id. Writes v() and w() of the links below the root as
/// calcForwardKinematics(true) does.
CNOID_GENERAL_EXPORT void calcMassMatrix(Body* body, const Vector3& g, MatrixXd& out_M, VectorXd& out_b);

}  // namespace cnoid
