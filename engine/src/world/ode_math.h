// Conversions between ODE's and Eigen's types. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <Eigen/Geometry>

namespace rehearse {

inline Eigen::Vector3d vector(const dReal* v) { return Eigen::Map<const Eigen::Vector3d>(v); }
inline Eigen::Quaterniond quaternion(const dReal* q) { return {q[0], q[1], q[2], q[3]}; }
inline Eigen::Matrix3d rotation(const dReal* r) {
  Eigen::Matrix3d matrix;
  matrix << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
  return matrix;
}

/// ODE's 3 x 4 row-major rotation.
struct OdeRotation {
  dMatrix3 r;
  explicit OdeRotation(const Eigen::Matrix3d& m) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) r[4 * row + column] = m(row, column);
      r[4 * row + 3] = 0.0;
    }
  }
};

/// Calls `use` with each number array of a body's pose and its size: position, quaternion, rotation. ODE returns
/// pointers to its own numbers; its setters would normalise the quaternion and so change bits.
template <class Use>
void visit_pose(dBodyID body, Use use) {
  use(dBodyGetPosition(body), 3);
  use(dBodyGetQuaternion(body), 4);
  use(dBodyGetRotation(body), 12);
}

}  // namespace rehearse
