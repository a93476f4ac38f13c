// The state of a body of ODE: what a checkpoint holds, how it is restored, and how its last bits are changed.
#include <cmath>
#include <limits>

#include "ode_body.h"
#include "ode_math.h"

namespace rehearse {

using Eigen::Vector3d;

void OdeBody::visit_state(StateVisitor& visitor) {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    visitor.begin_part(name(), model().links[group.first_link].name, StatePart::motion);
    // ODE's setters would normalise the quaternion and so change bits.
    const BodyNumbers& now = group.numbers;
    visitor.visit(Piece<3>(now.position), Piece<4>(now.quaternion), Piece<12>(now.rotation), Piece<3>(now.velocity),
                  Piece<3>(now.angular_velocity), Piece<3>(group.acceleration.data()),
                  Piece<3>(group.angular_acceleration.data()));
  }
  const auto visit_joints = [&](StatePart part, auto visit) {
    for (OdeJoint& joint : joints_) {
      visitor.begin_part(name(), joint.joint().name, part);
      visit(joint);
    }
  };
  visit_joints(StatePart::displacement, [&](OdeJoint& joint) { joint.visit_turns(visitor); });
  visit_joints(StatePart::effort, [&](OdeJoint& joint) { joint.visit_effort(visitor); });
  visit_joints(StatePart::acceleration, [&](OdeJoint& joint) { joint.visit_acceleration(visitor); });
  for (std::size_t id = 0; id < stages_.size(); ++id) {
    if (!stages_[id]) continue;
    const std::string& joint = model().links[model().joints[id]].joint.name;
    visitor.begin_part(name(), joint, StatePart::gear);
    joints_[slots_[id].index].visit_play(visitor);
    visitor.begin_part(name(), joint, StatePart::commands);
    stages_[id]->visit_state(visitor);
    visitor.begin_part(name(), joint, StatePart::lock);
    stages_[id]->visit_lock(visitor);
    visitor.begin_part(name(), joint, StatePart::heat);
    stages_[id]->visit_heat(visitor);
  }
  force_sensors_->visit_state(name(), model(), visitor);
  for (Track& track : tracks_) {
    visitor.begin_part(name(), model().links[track.link].joint.name, StatePart::belt);
    visitor.visit(track.speed);
  }
  visit_contact_sensors(visitor);
  visit_acting_devices(visitor);
}

void OdeBody::nudge(std::uint64_t bits) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    Vector3d position = vector(dBodyGetPosition(group.body));
    for (double& coordinate : position) {
      if (coordinate != 0.0) coordinate = std::nextafter(coordinate, bits & 1 ? infinite : -infinite);
      bits = bits >> 1 | bits << 63;
    }
    dBodySetPosition(group.body, position.x(), position.y(), position.z());
  }
}

void OdeBody::take_centers(const SimulatedBody& other) {
  const auto* recorded = dynamic_cast<const OdeBody*>(&other);
  if (!recorded) return;
  for (RigidGroup& group : groups_) {
    const int link = recorded->model().find_link(model().links[group.first_link].name);
    if (!group.body || link < 0) continue;
    const Vector3d moved = group.center - recorded->group_of(link).center;
    if (moved.isZero(0.0)) continue;
    const Vector3d arm = rotation(dBodyGetRotation(group.body)) * moved;
    const Vector3d w = vector(dBodyGetAngularVel(group.body));
    const Vector3d position = vector(dBodyGetPosition(group.body)) + arm;
    const Vector3d velocity = vector(dBodyGetLinearVel(group.body)) + w.cross(arm);
    dBodySetPosition(group.body, position.x(), position.y(), position.z());
    dBodySetLinearVel(group.body, velocity.x(), velocity.y(), velocity.z());
    const Vector3d arm_before = rotation_before(quaternion(dBodyGetQuaternion(group.body)), w, time_step_) * moved;
    const Vector3d w_before = w - time_step_ * group.angular_acceleration;
    group.acceleration = acceleration_at(arm_before, group.acceleration, w_before, group.angular_acceleration);
  }
}

void OdeBody::after_restore() {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    const Vector3d position = vector(dBodyGetPosition(group.body));
    dBodySetPosition(group.body, position.x(), position.y(), position.z());  // updates the poses of its geoms
  }
  for (OdeJoint& joint : joints_) joint.after_restore();
}

}  // namespace rehearse
