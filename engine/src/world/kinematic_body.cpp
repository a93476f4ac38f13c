#include "kinematic_body.h"

#include <algorithm>
#include <cmath>

#include "ode_math.h"

namespace rehearse {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// The rotation vector that turns `from` into `to` by the smaller angle [rad].
Vector3d turned(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  Eigen::Quaterniond difference = to * from.conjugate();
  if (difference.w() < 0.0) difference.coeffs() = -difference.coeffs();
  const double sine = difference.vec().norm();
  if (sine == 0.0) return Vector3d::Zero();
  return 2.0 * std::atan2(sine, difference.w()) / sine * difference.vec();
}

}  // namespace

KinematicBody::KinematicBody(dWorldID world, WorldBody body, double time_step)
    : SimulatedBody(std::move(body)), time_step_(time_step) {
  for (const double q : description().joints) joints_.push_back({q, 0.0, 0.0, 0.0});
  const Isometry3d root = pose_of(description().position, description().rotation);
  for (const Isometry3d& pose : forward_kinematics(model(), root, description().joints)) {
    LinkReading& link = links_.emplace_back();
    link.position = pose.translation();
    link.rotation = Eigen::Quaterniond(pose.linear()).normalized();
  }
  next_joints_ = joints_;
  next_links_ = links_;
  create_shapes(world);
  place();
}

void KinematicBody::create_shapes(dWorldID world) {
  bodies_.assign(model().links.size(), nullptr);
  for (std::size_t i = 0; i < model().links.size(); ++i) {
    const Link& link = model().links[i];
    const int belt = link.joint.type == JointType::track ? link.joint.id : -1;
    for (std::size_t shape = 0; shape < link.collisions.size(); ++shape) {
      if (!bodies_[i]) {
        bodies_[i] = dBodyCreate(world);
        dBodySetKinematic(bodies_[i]);
      }
      for (const auto& [geom, in_link] : add_shape(static_cast<int>(i), static_cast<int>(shape), belt)) {
        dGeomSetBody(geom, bodies_[i]);
        dGeomSetOffsetPosition(geom, in_link.translation().x(), in_link.translation().y(), in_link.translation().z());
        dGeomSetOffsetRotation(geom, OdeRotation(in_link.linear()).r);
      }
    }
  }
}

/// Moves ODE's bodies to the poses of the links.
void KinematicBody::place() {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!bodies_[i]) continue;
    const Vector3d& position = links_[i].position;
    dBodySetPosition(bodies_[i], position.x(), position.y(), position.z());
    dBodySetRotation(bodies_[i], OdeRotation(links_[i].rotation.toRotationMatrix()).r);
  }
}

double KinematicBody::kept(const Joint& joint, double displacement) const {
  return description().joint_limits ? std::clamp(displacement, joint.lower, joint.upper) : displacement;
}

double KinematicBody::wanted_displacement(std::size_t id, const JointCommand& command) const {
  const Joint& joint = model().links[model().joints[id]].joint;
  if (joint.type == JointType::track) return joints_[id].q;
  if (command.drive & drive_displacement) return kept(joint, command.q);
  if (command.drive & drive_velocity) return kept(joint, joints_[id].q + command.dq * time_step_);
  return joints_[id].q;
}

void KinematicBody::drive(const BodyCommand& command) {
  for (std::size_t id = 0; id < joints_.size(); ++id) next_joints_[id].q = wanted_displacement(id, command.joints[id]);
  std::vector<double> q;
  for (std::size_t id = 0; id < joints_.size(); ++id) {
    const Joint& joint = model().links[model().joints[id]].joint;
    if (joint.mimic) {
      next_joints_[id].q = joint.mimic->multiplier * next_joints_[joint.mimic->leader].q + joint.mimic->offset;
    }
    const bool is_belt = joint.type == JointType::track;
    const double belt_speed = command.joints[id].drive & drive_velocity ? command.joints[id].dq : 0.0;
    next_joints_[id].dq = is_belt ? belt_speed : (next_joints_[id].q - joints_[id].q) / time_step_;
    next_joints_[id].ddq = (next_joints_[id].dq - joints_[id].dq) / time_step_;
    q.push_back(next_joints_[id].q);
  }
  LinkReading root = links_[0];
  if (const auto given = command.given.find(0); given != command.given.end() && !root_is_fixed(description())) {
    const GivenMotion& motion = given->second;
    if (motion.place) {
      root.position = motion.place->position;
      root.rotation = motion.place->rotation.normalized();
    } else if (motion.twist) {
      root.position += time_step_ * motion.twist->velocity;
      root.rotation = rotation_after(root.rotation, motion.twist->angular_velocity, time_step_);
    }
  }
  const auto poses = forward_kinematics(model(), pose_of(root), q);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    LinkReading& next = next_links_[i];
    next.position = poses[i].translation();
    next.rotation = i == 0 ? root.rotation : Eigen::Quaterniond(poses[i].linear()).normalized();
    next.velocity = (next.position - links_[i].position) / time_step_;
    next.angular_velocity = turned(links_[i].rotation, next.rotation) / time_step_;
    next.acceleration = (next.velocity - links_[i].velocity) / time_step_;
    next.angular_acceleration = (next.angular_velocity - links_[i].angular_velocity) / time_step_;
    if (!bodies_[i]) continue;
    dBodySetLinearVel(bodies_[i], next.velocity.x(), next.velocity.y(), next.velocity.z());
    dBodySetAngularVel(bodies_[i], next.angular_velocity.x(), next.angular_velocity.y(), next.angular_velocity.z());
  }
}

Vector3d KinematicBody::link_point(int link, const Vector3d& point_in_link) const {
  return pose_of(links_[link]) * point_in_link;
}

Belt KinematicBody::belt(int index) const {
  const int link = model().joints[index];
  return {links_[link].rotation * model().links[link].joint.axis, next_joints_[index].dq};
}

void KinematicBody::after_step() {
  joints_ = next_joints_;
  links_ = next_links_;
  place();
}

void KinematicBody::observe(BodyObservation& observation, const WorldSettings& settings, bool stepped) const {
  observation.joints = joints_;
  observation.links = links_;
  observe_devices(observation, settings, stepped);
}

bool KinematicBody::plausible() const {
  return std::ranges::all_of(
      links_, [](const LinkReading& link) { return link.position.allFinite() && link.velocity.allFinite(); });
}

std::vector<dBodyID> KinematicBody::ode_bodies() const {
  std::vector<dBodyID> bodies;
  for (const dBodyID body : bodies_)
    if (body) bodies.push_back(body);
  return bodies;
}

void KinematicBody::visit_state(StateVisitor& visitor) {
  for (std::size_t id = 0; id < joints_.size(); ++id) {
    JointReading& joint = joints_[id];
    visitor.begin_part(name(), model().links[model().joints[id]].joint.name, StatePart::displacement);
    for (double* number : {&joint.q, &joint.dq, &joint.ddq}) visitor.visit(*number);
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    LinkReading& link = links_[i];
    visitor.begin_part(name(), model().links[i].name, StatePart::motion);
    visitor.visit(link.position);
    visitor.visit(link.rotation);
    for (Vector3d* numbers : {&link.velocity, &link.angular_velocity, &link.acceleration, &link.angular_acceleration})
      visitor.visit(*numbers);
  }
  visit_contact_sensors(visitor);
  visit_acting_devices(visitor);
}

}  // namespace rehearse
