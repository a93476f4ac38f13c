// Conversions between ODE's and Eigen's types. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

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

/// The acceleration of a point of a rigid body, at `arm` from another point whose acceleration is `a`: a + dw x r + w x
/// (w x r). World axes.
inline Eigen::Vector3d acceleration_at(const Eigen::Vector3d& arm, const Eigen::Vector3d& a, const Eigen::Vector3d& w,
                                       const Eigen::Vector3d& dw) {
  return a + dw.cross(arm) + w.cross(w.cross(arm));
}

/// The rotation at the end of a step with that angular velocity in world axes [rad/s]. ODE adds half of the angular
/// velocity times the quaternion.
inline Eigen::Quaterniond rotation_after(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& angular_velocity,
                                         double time_step) {
  const Eigen::Vector3d half = 0.5 * time_step * angular_velocity;
  return (Eigen::Quaterniond(1.0, half.x(), half.y(), half.z()) * rotation).normalized();
}

/// The rotation at the beginning of the step that ends with `rotation` and `angular_velocity`.
inline Eigen::Quaterniond rotation_before(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& angular_velocity,
                                          double time_step) {
  return rotation_after(rotation, -angular_velocity, time_step);
}

/// The angular velocity by which rotation_after() turns `from` to `to`, and almost half a turn at most.
inline Eigen::Vector3d angular_velocity_between(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to,
                                                double time_step) {
  constexpr double least = 1e-3;  // cosine of half the angle
  const Eigen::Quaterniond turn = to * from.conjugate();
  const double sign = turn.w() < 0.0 ? -1.0 : 1.0;
  return 2.0 / time_step * sign / std::max(std::abs(turn.w()), least) * turn.vec();
}

/// The places of a body's numbers in ODE, which stay as long as the body.
struct BodyNumbers {
  BodyNumbers() = default;
  explicit BodyNumbers(dBodyID body)
      : position(dBodyGetPosition(body)),
        quaternion(dBodyGetQuaternion(body)),
        rotation(dBodyGetRotation(body)),
        velocity(dBodyGetLinearVel(body)),
        angular_velocity(dBodyGetAngularVel(body)) {}

  const dReal* position = nullptr;
  const dReal* quaternion = nullptr;
  const dReal* rotation = nullptr;
  const dReal* velocity = nullptr;
  const dReal* angular_velocity = nullptr;
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
