#include "joint_guide.h"

#include "ode_math.h"

namespace rehearse {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/// Two unit vectors normal to `axis` and to each other.
struct Perpendiculars {
  Vector3d p, q;
  explicit Perpendiculars(const Vector3d& axis) {
    const dVector3 n{axis.x(), axis.y(), axis.z()};
    dVector3 first, second;
    dPlaneSpace(n, first, second);
    p = vector(first);
    q = vector(second);
  }
};

Vector3d center_of(dBodyID body) { return vector(dBodyGetPosition(body)); }
Matrix3d rotation_of(dBodyID body) { return body ? rotation(dBodyGetRotation(body)) : Matrix3d(Matrix3d::Identity()); }
Quaterniond quaternion_of(dBodyID body) {
  return body ? quaternion(dBodyGetQuaternion(body)) : Quaterniond::Identity();
}

}  // namespace

JointGuide::JointGuide(Type type, dBodyID first, dBodyID second, const Vector3d& anchor, const Vector3d& axis)
    : type_(type), first_(first), second_(second) {
  const Vector3d origin = second ? center_of(second) : Vector3d(Vector3d::Zero());
  const Matrix3d to_first = rotation_of(first).transpose(), to_second = rotation_of(second).transpose();
  anchor_ = to_first * (anchor - center_of(first));
  axis_ = to_first * axis;
  second_anchor_ = to_second * (anchor - origin);
  second_axis_ = to_second * axis;
  offset_ = to_second * (center_of(first) - origin);
  own_offset_ = to_first * (center_of(first) - origin);
  relative_ = quaternion_of(first).conjugate() * quaternion_of(second);
}

Vector3d JointGuide::axis() const { return rotation_of(first_) * axis_; }

Row JointGuide::axis_row(double target, double softness) const {
  Row row;
  const Vector3d along = axis(), none = Vector3d::Zero();
  row.target = target;
  row.softness = softness;
  if (type_ == Type::revolute) {
    row.first = spatial(none, along);
    row.second = spatial(none, -along);
    return row;
  }
  const Vector3d lever =
      second_ ? Vector3d((0.5 * (center_of(second_) - center_of(first_))).cross(along)) : Vector3d(none);
  row.first = spatial(along, lever);
  row.second = spatial(-along, lever);
  return row;
}

void JointGuide::add_rows(const StepLaw& law, JointRows& rows) const {
  switch (type_) {
    case Type::revolute: hold_anchor(law, rows); return hold_axis(law, rows);
    case Type::prismatic: hold_rotation(law, rows); return hold_line(law, rows);
    case Type::spherical: return hold_anchor(law, rows);
    case Type::fixed: hold_center(law, rows); return hold_rotation(law, rows);
  }
}

/// The anchors of both bodies have the same velocity.
void JointGuide::hold_anchor(const StepLaw& law, JointRows& rows) const {
  const Vector3d arm = rotation_of(first_) * anchor_, second_arm = rotation_of(second_) * second_anchor_;
  const Vector3d second_center = second_ ? center_of(second_) : Vector3d(Vector3d::Zero());
  const Vector3d error = second_arm + second_center - arm - center_of(first_);
  for (int i = 0; i < 3; ++i) {
    const Vector3d direction = Vector3d::Unit(i);
    Row& row = rows.add();
    row.first = spatial(direction, arm.cross(direction));
    row.second = -spatial(direction, second_arm.cross(direction));
    row.target = law.correction_rate * error[i];
    row.softness = law.softness;
  }
}

/// The bodies turn against each other about the axis only.
void JointGuide::hold_axis(const StepLaw& law, JointRows& rows) const {
  const Vector3d along = axis();
  const Vector3d error = along.cross(rotation_of(second_) * second_axis_);
  const Perpendiculars plane(along);
  for (const Vector3d& direction : {plane.p, plane.q}) {
    Row& row = rows.add();
    row.first.tail<3>() = direction;
    row.second.tail<3>() = -direction;
    row.target = law.correction_rate * error.dot(direction);
    row.softness = law.softness;
  }
}

/// The bodies don't turn against each other. The error is twice the vector part of the quaternion, for small angles.
void JointGuide::hold_rotation(const StepLaw& law, JointRows& rows) const {
  Quaterniond error = quaternion_of(first_).conjugate() * quaternion_of(second_) * relative_.conjugate();
  if (error.w() < 0.0) error.coeffs() = -error.coeffs();
  const Vector3d turn = 2.0 * (rotation_of(first_) * error.vec());
  for (int i = 0; i < 3; ++i) {
    Row& row = rows.add();
    row.first[3 + i] = 1.0;
    row.second[3 + i] = -1.0;
    row.target = law.correction_rate * turn[i];
    row.softness = law.softness;
  }
}

/// The bodies slide against each other along the axis only. With the rotations equal, the centres move as the mean of
/// both angular velocities demands.
void JointGuide::hold_line(const StepLaw& law, JointRows& rows) const {
  const Vector3d center = center_of(first_);
  const Vector3d between = second_ ? Vector3d(center_of(second_) - center) : Vector3d(Vector3d::Zero());
  const Vector3d error = second_ ? Vector3d(between + rotation_of(second_) * offset_) : Vector3d(offset_ - center);
  const Perpendiculars plane(axis());
  for (const Vector3d& direction : {plane.p, plane.q}) {
    const Vector3d lever = 0.5 * between.cross(direction);
    Row& row = rows.add();
    row.first = spatial(direction, lever);
    row.second = spatial(-direction, lever);
    row.target = law.correction_rate * error.dot(direction);
    row.softness = law.softness;
  }
}

/// The first body's place in the second one's frame stays.
void JointGuide::hold_center(const StepLaw& law, JointRows& rows) const {
  const Vector3d arm = rotation_of(first_) * own_offset_;
  const Vector3d error =
      second_ ? Vector3d(center_of(second_) - center_of(first_) + arm) : Vector3d(offset_ - center_of(first_));
  for (int i = 0; i < 3; ++i) {
    const Vector3d direction = Vector3d::Unit(i);
    Row& row = rows.add();
    // v1 = v2 + w1 x arm
    row.first = spatial(direction, second_ ? Vector3d(direction.cross(arm)) : Vector3d(Vector3d::Zero()));
    row.second.head<3>() = -direction;
    row.target = law.correction_rate * error[i];
    row.softness = law.softness;
  }
}

}  // namespace rehearse
