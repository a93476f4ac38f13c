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

/// In the middle of a step, what a body that turns with w has at `arm` at the beginning: the mean of `arm` and of what
/// ODE's rotation by half of h w makes of it (A. Cayley's map).
Vector3d halfway(const Vector3d& arm, const Vector3d& w, double time_step) {
  const Vector3d turn = 0.5 * time_step * w;
  return (arm + turn.cross(arm) + turn.dot(arm) * turn) / (1.0 + turn.squaredNorm());
}

}  // namespace

BodyPose BodyPose::of(dBodyID body) {
  if (!body) return {};
  return {vector(dBodyGetPosition(body)), rehearse::rotation(dBodyGetRotation(body)),
          rehearse::quaternion(dBodyGetQuaternion(body))};
}

BodyMotion BodyMotion::of(dBodyID body) {
  if (!body) return {};
  return {BodyPose::of(body), vector(dBodyGetLinearVel(body)), vector(dBodyGetAngularVel(body))};
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

BodyPose JointGuide::first_at(double displacement, const BodyPose& second) const {
  const Eigen::AngleAxisd turn(displacement, second.rotation * second_axis_);
  BodyPose first;
  first.quaternion = (turn * second.quaternion * relative_.conjugate()).normalized();
  first.rotation = first.quaternion.toRotationMatrix();
  first.center = second.center + second.rotation * second_anchor_ - first.rotation * anchor_;
  return first;
}

Vector3d JointGuide::between(const JointBodies& bodies) const {
  return second_ ? Vector3d(bodies.first.center - bodies.second.center) : Vector3d(Vector3d::Zero());
}

double JointGuide::rate(const JointBodies& bodies) const {
  const Vector3d along = bodies.first.rotation * axis_;
  const Vector3d &w = bodies.first.angular_velocity, &w2 = bodies.second.angular_velocity;
  if (type_ == Type::revolute) return along.dot(w - w2);
  return along.dot(bodies.first.velocity - bodies.second.velocity - 0.5 * (w + w2).cross(between(bodies)));
}

// With the arms a1 and a2 to the anchor, the centres move by v1 + w1 x a1 = v2 + w2 x a2 and w1 - w2 = q s. A slider's
// by v1 = v2 + (w1 + w2) / 2 x r + q s and w1 = w2.
JointMotion JointGuide::motion(const StepLaw& law, const JointBodies& bodies) const {
  const Vector3d along = bodies.first.rotation * axis_;
  JointMotion motion;
  if (type_ == Type::revolute) {
    const Vector3d arm = bodies.first.rotation * anchor_, turn = axis_target(law, bodies);
    motion.arm = bodies.second.rotation * second_anchor_ - arm;
    motion.bias = spatial(anchor_target(law, bodies) + arm.cross(turn), turn);
    motion.add(spatial(arm.cross(along), along));
    return motion;
  }
  REHEARSE_ASSERT(type_ == Type::prismatic, "the joint of a tree is a hinge or a slider");
  const Vector3d turn = rotation_target(law, bodies);
  motion.arm = between(bodies);
  motion.bias = spatial(line_target(law, bodies) + 0.5 * turn.cross(motion.arm), turn);
  motion.add(spatial(along, Vector3d::Zero()));
  return motion;
}

void JointGuide::add_rows(const StepLaw& law, const JointBodies& bodies, Rows& rows) const {
  switch (type_) {
    case Type::revolute: hold_anchor(law, bodies, rows); return hold_axis(law, bodies, rows);
    case Type::prismatic: hold_rotation(law, bodies, rows); return hold_line(law, bodies, rows);
    case Type::spherical: return hold_anchor(law, bodies, rows);
    case Type::fixed: hold_center(law, bodies, rows); return hold_rotation(law, bodies, rows);
  }
}

Vector3d JointGuide::anchor_target(const StepLaw& law, const JointBodies& bodies) const {
  const Vector3d arm = bodies.first.rotation * anchor_, second_arm = bodies.second.rotation * second_anchor_;
  const Vector3d error = second_arm + bodies.second.center - arm - bodies.first.center;
  const Vector3d &w = bodies.first.angular_velocity, &w2 = bodies.second.angular_velocity;
  return law.correction_rate * error + w2.cross(halfway(second_arm, w2, law.time_step) - second_arm) -
         w.cross(halfway(arm, w, law.time_step) - arm);
}

/// Without the part along the axis.
Vector3d JointGuide::axis_target(const StepLaw& law, const JointBodies& bodies) const {
  const Vector3d along = bodies.first.rotation * axis_;
  const Vector3d &w = bodies.first.angular_velocity, &w2 = bodies.second.angular_velocity;
  const Vector3d error = along.cross(bodies.second.rotation * second_axis_);
  return law.correction_rate * error + 0.5 * law.time_step * along.dot(w - w2) * w.cross(along);
}

/// The error is twice the vector part of the quaternion, for small angles.
Vector3d JointGuide::rotation_target(const StepLaw& law, const JointBodies& bodies) const {
  Quaterniond error = bodies.first.quaternion.conjugate() * bodies.second.quaternion * relative_.conjugate();
  if (error.w() < 0.0) error.coeffs() = -error.coeffs();
  return law.correction_rate * 2.0 * (bodies.first.rotation * error.vec());
}

/// The error is that across the axis.
Vector3d JointGuide::line_target(const StepLaw& law, const JointBodies& bodies) const {
  const Vector3d along = bodies.first.rotation * axis_, w = bodies.first.angular_velocity, arm = between(bodies);
  const Vector3d error = bodies.second.center - bodies.first.center + bodies.second.rotation * offset_;
  const Vector3d moved = arm + law.time_step * rate(bodies) * along;
  return law.correction_rate * (error - along.dot(error) * along) + w.cross(halfway(moved, w, law.time_step) - arm);
}

/// The anchors of both bodies have the same velocity.
void JointGuide::hold_anchor(const StepLaw& law, const JointBodies& bodies, Rows& rows) const {
  const Vector3d arm = bodies.first.rotation * anchor_, second_arm = bodies.second.rotation * second_anchor_;
  const Vector3d target = anchor_target(law, bodies);
  for (int i = 0; i < 3; ++i) {
    const Vector3d direction = Vector3d::Unit(i);
    Row& row = rows.add();
    row.first = spatial(direction, arm.cross(direction));
    row.second = -spatial(direction, second_arm.cross(direction));
    row.target = target[i];
    row.softness = law.softness;
  }
}

/// The bodies turn against each other about the axis only.
void JointGuide::hold_axis(const StepLaw& law, const JointBodies& bodies, Rows& rows) const {
  const Vector3d target = axis_target(law, bodies);
  const Perpendiculars plane(bodies.first.rotation * axis_);
  for (const Vector3d& direction : {plane.p, plane.q}) {
    Row& row = rows.add();
    row.first.tail<3>() = direction;
    row.second.tail<3>() = -direction;
    row.target = target.dot(direction);
    row.softness = law.softness;
  }
}

/// The bodies don't turn against each other.
void JointGuide::hold_rotation(const StepLaw& law, const JointBodies& bodies, Rows& rows) const {
  const Vector3d target = rotation_target(law, bodies);
  for (int i = 0; i < 3; ++i) {
    Row& row = rows.add();
    row.first[3 + i] = 1.0;
    row.second[3 + i] = -1.0;
    row.target = target[i];
    row.softness = law.softness;
  }
}

/// The bodies slide against each other along the axis only. With the rotations equal, the centres move as the mean of
/// both angular velocities demands.
void JointGuide::hold_line(const StepLaw& law, const JointBodies& bodies, Rows& rows) const {
  const Vector3d target = line_target(law, bodies), arm = between(bodies);
  const Perpendiculars plane(bodies.first.rotation * axis_);
  for (const Vector3d& direction : {plane.p, plane.q}) {
    const Vector3d lever = -0.5 * arm.cross(direction);
    Row& row = rows.add();
    row.first = spatial(direction, lever);
    row.second = spatial(-direction, lever);
    row.target = target.dot(direction);
    row.softness = law.softness;
  }
}

/// The first body's place in the second one's frame stays.
void JointGuide::hold_center(const StepLaw& law, const JointBodies& bodies, Rows& rows) const {
  const Vector3d arm = bodies.first.rotation * own_offset_, w = bodies.first.angular_velocity;
  Vector3d target = law.correction_rate * (bodies.second.center - bodies.first.center + (second_ ? arm : offset_));
  if (second_) target += w.cross(halfway(arm, w, law.time_step) - arm);
  for (int i = 0; i < 3; ++i) {
    const Vector3d direction = Vector3d::Unit(i);
    Row& row = rows.add();
    // v1 = v2 + w1 x arm
    row.first = spatial(direction, second_ ? Vector3d(direction.cross(arm)) : Vector3d(Vector3d::Zero()));
    row.second.head<3>() = -direction;
    row.target = target[i];
    row.softness = law.softness;
  }
}

}  // namespace rehearse
