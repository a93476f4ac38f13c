// Vectors and rotations as parts of messages.
#pragma once

#include <rehearse/messages.h>

#include <Eigen/Core>

namespace rehearse {

inline msg::Vector3 vector3(const double* v) { return {v[0], v[1], v[2]}; }
inline msg::Vector3 vector3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
template <class Vector>
Eigen::Vector3d eigen_vector(const Vector& v) {
  return {v.x, v.y, v.z};
}
inline msg::Point point(const double* v) { return {v[0], v[1], v[2]}; }
inline msg::Quaternion quaternion(const double* xyzw) { return {xyzw[0], xyzw[1], xyzw[2], xyzw[3]}; }

}  // namespace rehearse
