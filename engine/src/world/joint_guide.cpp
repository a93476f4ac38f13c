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

}  // namespace

BodyPose BodyPose::of(dBodyID body) {
  if (!body) return {};
  return {vector(dBodyGetPosition(body)), rehearse::rotation(dBodyGetRotation(body)),
          rehearse::quaternion(dBodyGetQuaternion(body))};
}

JointGuide::JointGuide(Type type, dBodyID first, dBodyID second, const Vector3d& anchor, const Vector3d& axis)
    : type_(type), first_(first), second_(second) {
  const BodyPose one = BodyPose::of(first), other = BodyPose::of(second);
  const Matrix3d to_first = one.rotation.transpose(), to_second = other.rotation.transpose();
  anchor_ = to_first * (anchor - one.center);
  axis_ = to_first * axis;
  second_anchor_ = to_second * (anchor - other.center);
  second_axis_ = to_second * axis;
  offset_ = to_second * (one.center - other.center);
  own_offset_ = to_first * (one.center - other.center);
  relative_ = one.quaternion.conjugate() * other.quaternion;
}

Row JointGuide::axis_row(const JointPoses& poses, double target, double softness) const {
  Row row;
  const Vector3d along = poses.first.rotation * axis_;
  row.target = target;
  row.softness = softness;
  if (type_ == Type::revolute) {
    row.first.tail<3>() = along;
    row.second.tail<3>() = -along;
    return row;
  }
  row.first.head<3>() = along;
  row.second.head<3>() = -along;
  if (second_) row.first.tail<3>() = (0.5 * (poses.second.center - poses.first.center)).cross(along);
  row.second.tail<3>() = row.first.tail<3>();
  return row;
}

BodyPose JointGuide::first_at(double displacement, const BodyPose& second) const {
  const Eigen::AngleAxisd turn(displacement, second.rotation * second_axis_);
  BodyPose first;
  first.quaternion = (turn * second.quaternion * relative_.conjugate()).normalized();
  first.rotation = first.quaternion.toRotationMatrix();
  first.center = second.center + second.rotation * second_anchor_ - first.rotation * anchor_;
  return first;
}

void JointGuide::add_rows(const StepLaw& law, const JointPoses& poses, JointRows& rows) const {
  switch (type_) {
    case Type::revolute: hold_anchor(law, poses, rows); return hold_axis(law, poses, rows);
    case Type::prismatic: hold_rotation(law, poses, rows); return hold_line(law, poses, rows);
    case Type::spherical: return hold_anchor(law, poses, rows);
    case Type::fixed: hold_center(law, poses, rows); return hold_rotation(law, poses, rows);
  }
}

/// The anchors of both bodies have the same velocity.
void JointGuide::hold_anchor(const StepLaw& law, const JointPoses& poses, JointRows& rows) const {
  const Vector3d arm = poses.first.rotation * anchor_, second_arm = poses.second.rotation * second_anchor_;
  const Vector3d error = second_arm + poses.second.center - arm - poses.first.center;
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
void JointGuide::hold_axis(const StepLaw& law, const JointPoses& poses, JointRows& rows) const {
  const Vector3d along = poses.first.rotation * axis_;
  const Vector3d error = along.cross(poses.second.rotation * second_axis_);
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
void JointGuide::hold_rotation(const StepLaw& law, const JointPoses& poses, JointRows& rows) const {
  Quaterniond error = poses.first.quaternion.conjugate() * poses.second.quaternion * relative_.conjugate();
  if (error.w() < 0.0) error.coeffs() = -error.coeffs();
  const Vector3d turn = 2.0 * (poses.first.rotation * error.vec());
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
void JointGuide::hold_line(const StepLaw& law, const JointPoses& poses, JointRows& rows) const {
  const Vector3d from = poses.second.center - poses.first.center;
  const Vector3d between = second_ ? from : Vector3d(Vector3d::Zero());
  const Vector3d error = from + poses.second.rotation * offset_;
  const Perpendiculars plane(poses.first.rotation * axis_);
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
void JointGuide::hold_center(const StepLaw& law, const JointPoses& poses, JointRows& rows) const {
  const Vector3d arm = poses.first.rotation * own_offset_;
  const Vector3d error = poses.second.center - poses.first.center + (second_ ? arm : offset_);
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
