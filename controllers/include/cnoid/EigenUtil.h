// Functions for rotations and vectors.
//
// Roll, pitch, yaw always mean R = Rz(yaw) * Ry(pitch) * Rx(roll), angles in [rad].
#pragma once

#include "Config.h"
#include "EigenTypes.h"
#include "MathUtil.h"

#include <memory>
#include <string>
#include <utility>

namespace cnoid {

inline Vector3 degree(const Vector3& radians) { return TO_DEGREE * radians; }
inline Vector3 radian(const Vector3& degrees) { return TO_RADIAN * degrees; }

CNOID_GENERAL_EXPORT Matrix3 rotFromRpy(double roll, double pitch, double yaw);
inline Matrix3 rotFromRpy(const Vector3& rpy) { return rotFromRpy(rpy.x(), rpy.y(), rpy.z()); }

/// Pitch is in [-pi/2, pi/2]. Within 1e-6 rad of either end roll and yaw are not unique: yaw is 0 there.
CNOID_GENERAL_EXPORT Vector3 rpyFromRot(const Matrix3& R);

/// Of all the angles that give R, returns the nearest to `previous`, so that a trajectory of angles has no jumps.
CNOID_GENERAL_EXPORT Vector3 rpyFromRot(const Matrix3& R, const Vector3& previous);

/// Rotation vector: the axis times the angle, 0 to pi [rad].
CNOID_GENERAL_EXPORT Vector3 omegaFromRot(const Matrix3& R);

/// The matrix of the cross product: hat(x) * y == x.cross(y).
CNOID_GENERAL_EXPORT Matrix3 hat(const Vector3& x);

/// The numbers separated by spaces, in the shortest form that reads back as the same value.
CNOID_GENERAL_EXPORT std::string str(const Vector2& v);
CNOID_GENERAL_EXPORT std::string str(const Vector3& v);
CNOID_GENERAL_EXPORT std::string str(const Vector3f& v);
/// Axis, then angle [rad].
CNOID_GENERAL_EXPORT std::string str(const AngleAxis& a);

/// Reads as many numbers as the vector has, separated by spaces or single commas. Returns false if the text contains
/// anything else; `v` may then be partly written. The decimal point is always '.', whatever the locale.
CNOID_GENERAL_EXPORT bool toVector3(const std::string& text, Vector3& v);
CNOID_GENERAL_EXPORT bool toVector3(const std::string& text, Vector3f& v);
CNOID_GENERAL_EXPORT bool toVector6(const std::string& text, Vector6& v);

/// Makes a rotation orthonormal again after rounding errors. Keeps the direction of the x column.
CNOID_GENERAL_EXPORT void normalizeRotation(Matrix3& R);
CNOID_GENERAL_EXPORT void normalizeRotation(Affine3& T);
CNOID_GENERAL_EXPORT void normalizeRotation(Isometry3& T);

template <class T, typename... Args>
std::shared_ptr<T> make_shared_aligned(Args&&... args) {
  return std::allocate_shared<T>(Eigen::aligned_allocator<T>(), std::forward<Args>(args)...);
}

}  // namespace cnoid
