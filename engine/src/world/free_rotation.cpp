#include "free_rotation.h"

#include <Eigen/Geometry>
#include <cmath>

namespace rehearse {
namespace {

using Eigen::Vector3d;

/// Turns v by atan(|t|) about t.
inline Vector3d turn(const Vector3d& t, const Vector3d& v) {
  const double cosine = 1.0 / std::sqrt(1.0 + t.squaredNorm());
  return cosine * (v + t.cross(v)) + cosine * cosine / (1.0 + cosine) * t.dot(v) * t;
}

}  // namespace

std::optional<Vector3d> rotate_freely(const Eigen::Matrix3d& inertia, const Eigen::Matrix3d& inverse,
                                      const Vector3d& angular_velocity, double time_step) {
  constexpr int most_iterations = 30;
  constexpr double accuracy = 1e-13;
  const double half_step = 0.5 * time_step;
  const auto acceleration = [&](const Vector3d& w) -> Vector3d { return inverse * (inertia * w).cross(w); };
  // begin with the midpoint rule
  Vector3d next =
      angular_velocity + time_step * acceleration(angular_velocity + half_step * acceleration(angular_velocity));
  const Vector3d momentum = turn(-half_step * angular_velocity, inertia * angular_velocity);
  for (int i = 0; i < most_iterations; ++i) {
    const Vector3d better = inverse * turn(-half_step * next, momentum);
    const double change = (better - next).squaredNorm();
    next = better;
    if (change <= accuracy * accuracy * next.squaredNorm()) return next;
  }
  return std::nullopt;
}

}  // namespace rehearse
