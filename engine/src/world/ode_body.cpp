#include "ode_body.h"

#include <cmath>
#include <limits>
#include <optional>

#include "free_rotation.h"
#include "model/acting_faults.h"
#include "ode_math.h"

namespace rehearse {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

OdeBody::OdeBody(dWorldID world, WorldBody body, double time_step)
    : SimulatedBody(std::move(body)), time_step_(time_step) {
  dVector3 gravity;
  dWorldGetGravity(world, gravity);
  gravity_ = vector(gravity);
  const Isometry3d root = pose_of(description().position, description().rotation);
  const auto zero_posture = forward_kinematics(model(), root, std::vector<double>(model().joints.size(), 0.0));

  const RigidGroups groups = group_links(model());
  links_ = groups.links;
  create_groups(world, groups, zero_posture);
  create_joints(world, zero_posture);  // an ODE joint angle is zero at the pose in which the joint was made
  force_sensors_.emplace(model(), groups, [this](int id) -> OdeJoint& { return joints_[slots_[id].index]; });
  for (const int link : force_sensors_->feeling_links()) feel(link);
  create_shapes();
  pair_own_shapes();
  const auto posture = forward_kinematics(model(), root, description().joints);
  set_posture(posture);
  if (description().planar && groups_.front().body) plane_.emplace(world, groups_.front().body);
  set_velocities(initial_motions(description(), posture));
  for (std::size_t id = 0; id < slots_.size(); ++id)
    if (!slots_[id].is_track) joints_[slots_[id].index].begin(description().joints[id]);
}

void OdeBody::create_groups(dWorldID world, const RigidGroups& groups, const std::vector<Isometry3d>& zero_posture) {
  groups_.resize(groups.first_links.size());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    RigidGroup& group = groups_[i];
    group.first_link = groups.first_links[i];
    group.fixed_pose = zero_posture[group.first_link];
    if (has_joint(model(), group.first_link)) group.parent = links_[model().links[group.first_link].parent].group;
    if (i == 0 && root_is_fixed(description())) continue;
    const Inertial& inertial = groups.inertials[i];
    group.center = inertial.center;
    group.body = dBodyCreate(world);
    group.numbers = BodyNumbers(group.body);
    group.nominal = {inertial.mass, inertial.inertia};
    moving_mass_ += inertial.mass;
    set_mass(group, 1.0);
  }
  release_weightless();
  set_posture(zero_posture);
}

void OdeBody::set_mass(RigidGroup& group, double factor) {
  group.factor = factor;
  group.weight = {factor * group.nominal.mass, factor * group.nominal.inertia};
  const Matrix3d& inertia = group.weight.inertia;
  group.inverse_inertia = inertia.inverse();
  dMass mass;
  dMassSetParameters(&mass, group.weight.mass, 0.0, 0.0, 0.0, inertia(0, 0), inertia(1, 1), inertia(2, 2),
                     inertia(0, 1), inertia(0, 2), inertia(1, 2));
  dBodySetMass(group.body, &mass);
}

/// In the step that begins at `time` [s].
double OdeBody::mass_factor(std::size_t group, double time) const {
  double factor = 1.0;
  for (const MassFault& fault : description().mass_faults)
    if (links_[fault.link].group == static_cast<int>(group) && acts(fault.from, fault.until, time, time_step_))
      factor *= fault.factor;
  return factor;
}

/// The masses follow from the time alone, so they aren't state. ODE's velocities are those of the centres of mass,
/// which stay.
void OdeBody::take_masses(double time) {
  changes_mass_ = false;
  double added = 0.0;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    RigidGroup& group = groups_[i];
    if (!group.body) continue;
    const double factor = mass_factor(i, time);
    changes_mass_ |= factor != mass_factor(i, time - time_step_);
    if (factor != group.factor) set_mass(group, factor);
    added += group.weight.mass - group.nominal.mass;
  }
  add_mass(added);
}

/// ODE disables gravity for bodies, not for parts of them: parts are held up by a force at their common centre.
void OdeBody::release_weightless() {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = model().links[i];
    RigidGroup& group = groups_[links_[i].group];
    if (!group.body || link.has_weight || link.inertial.mass == 0.0) continue;
    group.weightless_mass += link.inertial.mass;
    group.weightless_moment += link.inertial.mass * (links_[i].in_group * link.inertial.center - group.center);
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    if (!groups_[i].body || has_weight(static_cast<int>(i))) continue;
    dBodySetGravityMode(groups_[i].body, 0);
    groups_[i].weightless_mass = 0.0;
  }
}

bool OdeBody::has_weight(int group) const {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = model().links[i];
    if (links_[i].group == group && link.has_weight && link.inertial.mass > 0.0) return true;
  }
  return false;
}

void OdeBody::hold_up_weightless() {
  for (const RigidGroup& group : groups_) {
    if (group.weightless_mass == 0.0) continue;
    const Vector3d force = -group.factor * group.weightless_mass * gravity_;
    const Vector3d arm = group.weightless_moment / group.weightless_mass;
    dBodyAddForceAtRelPos(group.body, force.x(), force.y(), force.z(), arm.x(), arm.y(), arm.z());
  }
}

void OdeBody::create_joints(dWorldID world, const std::vector<Isometry3d>& zero_posture) {
  for (const int index : model().joints) {
    const Link& link = model().links[index];
    if (link.joint.type == JointType::track) {
      slots_.push_back({true, static_cast<int>(tracks_.size())});
      tracks_.push_back({index, 0.0});
      continue;
    }
    REHEARSE_ASSERT(is_movable(link.joint.type), "only movable joints and tracks have an id");
    slots_.push_back({false, static_cast<int>(joints_.size())});
    const RigidGroup& child = group_of(index);
    joints_.emplace_back(world, link.joint, child.body, group_of(link.parent).body, zero_posture[index],
                         KeptLimits{description().joint_limits && !link.joint.mimic, description().effort_limits},
                         actuator_of(link.joint.id));
    if (!description().drive_limits && !link.joint.mimic) joints_.back().limit_drive(unlimited, unlimited);
    has_resistance_ |= joints_.back().resists();
  }
  stages_.resize(description().actuators.size());
  for (std::size_t id = 0; id < stages_.size(); ++id)
    if (const Actuator* actuator = actuator_of(static_cast<int>(id)))
      stages_[id].emplace(*actuator, description().joints[id], time_step_);
}

const Actuator* OdeBody::actuator_of(int id) const {
  const std::vector<std::optional<Actuator>>& all = description().actuators;
  return all.empty() || !all[id] ? nullptr : &*all[id];
}

void OdeBody::create_shapes() {
  for (std::size_t i = 0; i < model().links.size(); ++i) {
    const RigidGroup& group = group_of(static_cast<int>(i));
    const Joint& joint = model().links[i].joint;
    const int belt = joint.type == JointType::track ? slots_[joint.id].index : -1;
    for (std::size_t shape = 0; shape < model().links[i].collisions.size(); ++shape) {
      for (const AddedGeom& added : add_shape(static_cast<int>(i), static_cast<int>(shape), belt))
        place_shape(added.geom, group, links_[i].in_group * added.in_link);
    }
  }
}

void OdeBody::place_shape(dGeomID geom, const RigidGroup& group, const Isometry3d& in_group) {
  if (group.body) {
    const Vector3d offset = in_group.translation() - group.center;
    dGeomSetBody(geom, group.body);
    dGeomSetOffsetPosition(geom, offset.x(), offset.y(), offset.z());
    dGeomSetOffsetRotation(geom, OdeRotation(in_group.linear()).r);
  } else {
    const Isometry3d pose = group.fixed_pose * in_group;
    dGeomSetPosition(geom, pose.translation().x(), pose.translation().y(), pose.translation().z());
    dGeomSetRotation(geom, OdeRotation(pose.linear()).r);
  }
}

void OdeBody::set_posture(const std::vector<Isometry3d>& poses) {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    const Isometry3d& frame = poses[group.first_link];
    const Vector3d center = frame * group.center;
    dBodySetPosition(group.body, center.x(), center.y(), center.z());
    dBodySetRotation(group.body, OdeRotation(frame.linear()).r);
  }
}

void OdeBody::set_velocities(const std::vector<LinkMotion>& motions) {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    const Vector3d& w = motions[group.first_link].angular_velocity;
    const Vector3d v =
        motions[group.first_link].velocity + w.cross(rotation(dBodyGetRotation(group.body)) * group.center);
    dBodySetLinearVel(group.body, v.x(), v.y(), v.z());
    dBodySetAngularVel(group.body, w.x(), w.y(), w.z());
  }
}

void OdeBody::before_step(double time) {
  if (!description().mass_faults.empty()) take_masses(time);
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    group.previous_velocity = vector(dBodyGetLinearVel(group.body));
    group.previous_angular_velocity = vector(dBodyGetAngularVel(group.body));
  }
  for (OdeJoint& joint : joints_) joint.before_step(time_step_);
  force_sensors_->begin_step(groups_);
}

void OdeBody::drive(const BodyCommand& command) {
  REHEARSE_ASSERT(command.joints.size() == slots_.size(), "a command has an entry for each joint");
  hold_up_weightless();
  if (plane_) plane_->correct(time_step_);
  for (const auto& [link, motion] : command.given) give_motion(link, motion);
  turn_freely();
  apply_rotors();
  if (!stages_.empty()) act(command);
  if (has_resistance_) resist_motions();
  for (std::size_t id = 0; id < slots_.size(); ++id) {
    const JointCommand& wanted = stages_.empty() ? command.joints[id] : acting_[id];
    if (slots_[id].is_track) {
      tracks_[slots_[id].index].speed = wanted.drive & drive_velocity ? wanted.dq : 0.0;
      continue;
    }
    OdeJoint& joint = joints_[slots_[id].index];
    if (const auto& mimic = joint.joint().mimic)
      joint.follow(joints_[slots_[mimic->leader].index], time_step_);
    else
      joint.drive(wanted, time_step_);
  }
}

/// Passes the commands through the actuators.
void OdeBody::act(const BodyCommand& command) {
  acting_ = command.joints;
  for (std::size_t id = 0; id < stages_.size(); ++id) {
    if (!stages_[id]) continue;
    OdeJoint& joint = joints_[slots_[id].index];
    acting_[id] = stages_[id]->act(command.joints[id], joint.reading());
    joint.limit_drive(stages_[id]->drive_share(), stages_[id]->thermal_limit());
    joint.lean_effort(stages_[id]->slope());
    joint.turn_rotor(acting_[id], time_step_);
  }
}

/// ODE's bodies without inertia keep their velocity in a step, and no force changes it.
void OdeBody::give_motion(int link, const GivenMotion& motion) {
  const RigidGroup& group = group_of(link);
  if (!group.body || group.first_link != link || has_joint(model(), link) || (!motion.place && !motion.twist)) return;
  const Eigen::Quaterniond now = quaternion(dBodyGetQuaternion(group.body));
  Vector3d velocity, angular_velocity;
  if (motion.place) {
    const Eigen::Quaterniond wanted = motion.place->rotation.normalized();
    const Vector3d center = motion.place->position + wanted * group.center;
    velocity = (center - vector(dBodyGetPosition(group.body))) / time_step_;
    angular_velocity = angular_velocity_between(now, wanted, time_step_);
  } else {
    angular_velocity = motion.twist->angular_velocity;
    velocity = motion.twist->velocity + angular_velocity.cross(now * group.center);
  }
  dBodySetKinematic(group.body);
  dBodySetLinearVel(group.body, velocity.x(), velocity.y(), velocity.z());
  dBodySetAngularVel(group.body, angular_velocity.x(), angular_velocity.y(), angular_velocity.z());
}

/// Applies the gyroscopic torques. ODE's own lose energy and add angular momentum; they remain for bodies that turn too
/// fast for the step.
void OdeBody::turn_freely() {
  for (const RigidGroup& group : groups_) {
    if (!group.body || dBodyIsKinematic(group.body)) continue;
    const Matrix3d axes = rotation(dBodyGetRotation(group.body));
    const Vector3d before = axes.transpose() * vector(dBodyGetAngularVel(group.body));
    const auto after = rotate_freely(group.weight.inertia, group.inverse_inertia, before, time_step_);
    dBodySetGyroscopicMode(group.body, after ? 0 : 1);
    if (!after) continue;
    const Vector3d torque = axes * (group.weight.inertia * (*after - before)) / time_step_;
    dBodyAddTorque(group.body, torque.x(), torque.y(), torque.z());
  }
}

void OdeBody::resist_motions() {
  std::optional<JointInertias> inertias;  // only dampers need them
  for (std::size_t id = 0; id < slots_.size(); ++id) {
    if (slots_[id].is_track) continue;
    OdeJoint& joint = joints_[slots_[id].index];
    if (!joint.resists()) continue;
    double inertia = 1.0;  // without a damper it has no effect
    if (joint.damps()) {
      if (!inertias) inertias.emplace(rigid_parts());
      const int part = links_[model().joints[id]].group;
      const Vector3d axis = joint.world_axis();
      inertia = joint.revolute() ? inertias->about(part, axis, joint.anchor()) : inertias->along(part, axis);
    }
    joint.resist(inertia, time_step_);
  }
}

std::vector<RigidPart> OdeBody::rigid_parts() const {
  std::vector<RigidPart> parts(groups_.size());
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    parts[i].parent = groups_[i].parent;
    const dBodyID body = groups_[i].body;
    parts[i].moves = body != nullptr;
    if (!body) continue;
    const Matrix3d axes = rotation(dBodyGetRotation(body));
    parts[i].mass = groups_[i].weight.mass;
    parts[i].center = vector(dBodyGetPosition(body));
    parts[i].inertia = axes * groups_[i].weight.inertia * axes.transpose();
  }
  return parts;
}

Mount OdeBody::mount(int link) const {
  const RigidGroup& group = group_of(link);
  const Isometry3d& in_group = links_[link].in_group;
  if (!group.body) return {nullptr, group.fixed_pose * in_group};
  return {group.body, Eigen::Translation3d(-group.center) * in_group};
}

void OdeBody::add_wrench(int link, const Vector3d& force, const Vector3d& torque_about_origin) {
  force_sensors_->add_wrench(link, force, torque_about_origin);
  const dBodyID body = group_of(link).body;
  if (!body) return;
  const Vector3d torque = torque_about_origin - vector(dBodyGetPosition(body)).cross(force);
  dBodyAddForce(body, force.x(), force.y(), force.z());
  dBodyAddTorque(body, torque.x(), torque.y(), torque.z());
}

Vector3d OdeBody::link_point(int link, const Vector3d& point_in_link) const {
  const RigidGroup& group = group_of(link);
  const Vector3d in_group = links_[link].in_group * point_in_link;
  if (!group.body) return group.fixed_pose * in_group;
  return vector(dBodyGetPosition(group.body)) + rotation(dBodyGetRotation(group.body)) * (in_group - group.center);
}

Belt OdeBody::belt(int index) const {
  const Track& track = tracks_[index];
  const RigidGroup& group = group_of(track.link);
  const Matrix3d group_axes = group.body ? rotation(dBodyGetRotation(group.body)) : Matrix3d(group.fixed_pose.linear());
  return {group_axes * (links_[track.link].in_group.linear() * model().links[track.link].joint.axis), track.speed};
}

JointErrors OdeBody::residual() const {
  constexpr double standard_gravity = 9.80665;  // [m/s²]
  JointErrors worst;
  double most = 0.0;  // [N·s]
  for (const int index : model().joints) {
    const Joint& joint = model().links[index].joint;
    if (slots_[joint.id].is_track) continue;
    if (!dBodyIsEnabled(group_of(index).body)) continue;  // another solver moves it
    const OdeJoint& connected = joints_[slots_[joint.id].index];
    if (const double velocity = connected.missed_velocity(); velocity > worst.velocity) {
      worst.missed = index;
      worst.velocity = velocity;
    }
    const double missing = connected.missing_impulse();
    if (missing <= most && worst.link >= 0) continue;
    most = missing;
    worst.link = index;
  }
  if (worst.link >= 0) worst.share = most / ((moving_mass_ + added_mass()) * standard_gravity * time_step_);
  return worst;
}

void OdeBody::after_step() {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    group.acceleration = (vector(dBodyGetLinearVel(group.body)) - group.previous_velocity) / time_step_;
    group.angular_acceleration =
        (vector(dBodyGetAngularVel(group.body)) - group.previous_angular_velocity) / time_step_;
    if (dBodyIsKinematic(group.body)) dBodySetDynamic(group.body);
  }
  for (OdeJoint& joint : joints_) joint.after_step(time_step_);
  for (std::size_t id = 0; id < stages_.size(); ++id)
    if (stages_[id]) stages_[id]->take_effort(joints_[slots_[id].index].reading().u);
  force_sensors_->measure(model(), groups_, touches(), gravity_);
}

void OdeBody::read_link(int index, LinkReading& link) const {
  const RigidGroup& group = group_of(index);
  if (!group.body) {
    const Isometry3d pose = group.fixed_pose * links_[index].in_group;
    link.position = pose.translation();
    link.rotation = Eigen::Quaterniond(pose.linear()).normalized();
    return;
  }
  const BodyNumbers& now = group.numbers;
  const Vector3d origin = links_[index].in_group.translation() - group.center;
  const Vector3d arm = rotation(now.rotation) * origin;
  const Vector3d w = vector(now.angular_velocity);
  link.position = vector(now.position) + arm;
  link.rotation = quaternion(now.quaternion);
  const Vector3d arm_before = rotation_before(link.rotation, w, time_step_) * origin;
  const Vector3d w_before = w - time_step_ * group.angular_acceleration;
  if (!links_[index].leads_group) link.rotation = link.rotation * links_[index].rotation_in_group;
  link.velocity = vector(now.velocity) + w.cross(arm);
  link.angular_velocity = w;
  link.acceleration = acceleration_at(arm_before, group.acceleration, w_before, group.angular_acceleration);
  link.angular_acceleration = group.angular_acceleration;
}

void OdeBody::observe(BodyObservation& observation, const WorldSettings& settings, bool stepped) const {
  observation.joints.resize(slots_.size());
  observation.links.resize(links_.size());
  for (std::size_t id = 0; id < slots_.size(); ++id) {
    if (slots_[id].is_track)
      observation.joints[id] = {0.0, tracks_[slots_[id].index].speed, 0.0, 0.0};
    else
      observation.joints[id] = joints_[slots_[id].index].reading();
  }
  if (!stages_.empty()) observe_actuators(observation);
  for (std::size_t i = 0; i < links_.size(); ++i) read_link(static_cast<int>(i), observation.links[i]);
  observe_devices(observation, settings, stepped);
}

/// A drive without a loop exerts what its motion needs.
void OdeBody::observe_actuators(BodyObservation& observation) const {
  observation.actuators.resize(stages_.size());
  for (std::size_t id = 0; id < stages_.size(); ++id) {
    const JointReading& joint = observation.joints[id];
    ActuatorReading& reading = observation.actuators[id];
    reading = {joint.q, joint.dq, joint.u, joint.u};
    if (!stages_[id]) continue;
    reading.thermal_limit = stages_[id]->thermal_limit();
    if (stages_[id]->drives_effort()) {
      reading.wanted = stages_[id]->wanted();
      reading.effort = stages_[id]->effort();
    }
    const GearPlay* play = joints_[slots_[id].index].play();
    if (!play || !play->begun()) continue;
    reading.q = play->displacement();
    reading.dq = play->rate();
  }
}

void OdeBody::read_force(std::size_t device, std::vector<double>& values) const {
  force_sensors_->read(device, values);
}

bool OdeBody::plausible() const {
  for (const RigidGroup& group : groups_) {
    if (!group.body) continue;
    const Vector3d velocity = vector(dBodyGetLinearVel(group.body)), spin = vector(dBodyGetAngularVel(group.body));
    if (!vector(dBodyGetPosition(group.body)).allFinite()) return false;
    // numbers that aren't finite fail too
    if (!(velocity.cwiseAbs().maxCoeff() < most_velocity) || !(spin.cwiseAbs().maxCoeff() < most_velocity))
      return false;
  }
  return true;
}

std::vector<dBodyID> OdeBody::ode_bodies() const {
  std::vector<dBodyID> bodies;
  for (const RigidGroup& group : groups_)
    if (group.body) bodies.push_back(group.body);
  return bodies;
}

std::vector<MovingPart> OdeBody::moving_parts() {
  std::vector<MovingPart> parts;
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const RigidGroup& group = groups_[i];
    if (!group.body) continue;
    MovingPart& part = parts.emplace_back();
    part.body = group.body;
    part.weight = &group.weight;
    if (i == 0 && plane_) part.plane = &*plane_;
    if (group.parent < 0) continue;
    part.parent = groups_[group.parent].body;
    const Joint& joint = model().links[group.first_link].joint;
    part.joint = &joints_[slots_[joint.id].index];
    if (joint.mimic) part.leader = &joints_[slots_[joint.mimic->leader].index];
  }
  return parts;
}

}  // namespace rehearse
