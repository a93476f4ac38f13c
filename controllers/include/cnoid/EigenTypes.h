// The vector, matrix and transform types of the API. All are Eigen's; double unless the name states a different type.
//
// Rehearse passes objects that contain these types to a controller that was compiled separately, so their alignment
// must not depend on compiler flags: with -mavx2 Eigen would align to 32 bytes and move every member behind an
// Isometry3.
#pragma once

#ifndef EIGEN_MAX_ALIGN_BYTES
#define EIGEN_MAX_ALIGN_BYTES 16
#endif
#include <Eigen/Core>
#include <Eigen/Geometry>

static_assert(EIGEN_MAX_ALIGN_BYTES == 16,
              "Eigen was included before <cnoid/...> with another alignment: compile with -DEIGEN_MAX_ALIGN_BYTES=16");

namespace cnoid {

using Eigen::Array2d;
using Eigen::Array2f;
using Eigen::Array2i;
using Eigen::Array3d;
using Eigen::Array3f;
using Eigen::Array3i;
using Eigen::Array4d;
using Eigen::Array4f;
using Eigen::Array4i;
using Eigen::Matrix2d;
using Eigen::Matrix2f;
using Eigen::Matrix3d;
using Eigen::Matrix3f;
using Eigen::Matrix4d;
using Eigen::Matrix4f;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::Vector2d;
using Eigen::Vector2f;
using Eigen::Vector2i;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;
using Eigen::Vector4d;
using Eigen::Vector4f;
using Eigen::VectorXd;
using Eigen::VectorXf;

using Eigen::Affine3d;
using Eigen::Affine3f;
using Eigen::AngleAxisd;
using Eigen::AngleAxisf;
using Eigen::Isometry3d;
using Eigen::Isometry3f;
using Eigen::Quaterniond;
using Eigen::Quaternionf;
using Eigen::Translation3d;
using Eigen::Translation3f;

using Matrix2 = Eigen::Matrix2d;
using Matrix3 = Eigen::Matrix3d;
using Matrix4 = Eigen::Matrix4d;
using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Vector4 = Eigen::Vector4d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using VectorX = Eigen::VectorXd;

using Affine3 = Eigen::Affine3d;
using AngleAxis = Eigen::AngleAxisd;
using Isometry3 = Eigen::Isometry3d;
using Quaternion = Eigen::Quaterniond;
using Translation3 = Eigen::Translation3d;

using Position [[deprecated("Use Isometry3.")]] = Isometry3;
using Quat [[deprecated("Use Quaternion.")]] = Quaternion;

/// A pose as a translation and a unit quaternion.
class SE3 {
 public:
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  /// Uninitialised, like Eigen's own types.
  SE3() = default;
  SE3(const Vector3& translation, const Quaternion& rotation) : translation_(translation), rotation_(rotation) {}
  SE3(const Vector3& translation, const Matrix3& rotation) : translation_(translation), rotation_(rotation) {}
  SE3(const Isometry3& pose) : translation_(pose.translation()), rotation_(pose.linear()) {}

  void set(const Vector3& translation, const Quaternion& rotation) { *this = SE3(translation, rotation); }
  void set(const Vector3& translation, const Matrix3& rotation) { *this = SE3(translation, rotation); }
  void set(const Isometry3& pose) { *this = SE3(pose); }
  void clear() { *this = SE3(Isometry3::Identity()); }

  Vector3& translation() { return translation_; }
  const Vector3& translation() const { return translation_; }
  Quaternion& rotation() { return rotation_; }
  const Quaternion& rotation() const { return rotation_; }

 private:
  Vector3 translation_;
  Quaternion rotation_;
};

}  // namespace cnoid
