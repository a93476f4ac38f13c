#include "ode_body.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rehearse {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d vector(const dReal* v) { return {v[0], v[1], v[2]}; }
Quaterniond quaternion(const dReal* q) { return {q[0], q[1], q[2], q[3]}; }
Matrix3d rotation(const dReal* r) {
  Matrix3d matrix;
  matrix << r[0], r[1], r[2], r[4], r[5], r[6], r[8], r[9], r[10];
  return matrix;
}

/// ODE's 3 x 4 row-major rotation.
struct OdeRotation {
  dMatrix3 r;
  explicit OdeRotation(const Matrix3d& m) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) r[4 * row + column] = m(row, column);
      r[4 * row + 3] = 0.0;
    }
  }
};

bool moves_freely(const Joint& joint) {
  return joint.type == JointType::revolute || joint.type == JointType::continuous || joint.type == JointType::prismatic;
}

bool root_is_fixed(const WorldBody& description) {
  return description.fixed || description.model->links[0].joint.type == JointType::fixed;
}

/// For each link the index of the link that leads its rigid group.
std::vector<int> group_leaders(const Model& model) {
  std::vector<int> leaders(model.links.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    const bool held = link.parent >= 0 && link.joint.type == JointType::fixed;
    leaders[i] = held ? leaders[link.parent] : static_cast<int>(i);
  }
  return leaders;
}

/// The sum of two inertials given in one frame; parallel axis theorem.
Inertial sum(const Inertial& a, const Inertial& b) {
  if (a.mass == 0.0) return b;
  if (b.mass == 0.0) return a;
  Inertial total;
  total.mass = a.mass + b.mass;
  total.center = (a.mass * a.center + b.mass * b.center) / total.mass;
  for (const Inertial* part : {&a, &b}) {
    const Vector3d d = part->center - total.center;
    total.inertia += part->inertia + part->mass * (d.squaredNorm() * Matrix3d::Identity() - d * d.transpose());
  }
  return total;
}

/// Mass, centre and inertia of the group that `leader` leads, in its frame.
Inertial group_inertial(const Model& model, const std::vector<int>& leaders, int leader,
                        const std::vector<Isometry3d>& zero_posture) {
  Inertial total;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (leaders[i] != leader || model.links[i].inertial.mass == 0.0) continue;
    Inertial part = model.links[i].inertial;
    if (static_cast<int>(i) != leader) {
      const Isometry3d in_group = zero_posture[leader].inverse(Eigen::Isometry) * zero_posture[i];
      part.center = in_group * part.center;
      part.inertia = in_group.linear() * part.inertia * in_group.linear().transpose();
    }
    total = sum(total, part);
  }
  return total;
}

bool positive_definite(const Matrix3d& inertia) {
  if (!inertia.allFinite()) return false;
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() > 0.0;
}

}  // namespace

Diagnostics OdeBody::check(const WorldBody& description) {
  const Model& model = *description.model;
  const std::string body = "body '" + description.name + "': ";
  Diagnostics findings;
  if (description.joints.size() != model.joints.size()) {
    findings.push_back(error(body + "the model has " + std::to_string(model.joints.size()) + " joints, but " +
                             std::to_string(description.joints.size()) + " initial displacements were given"));
    return findings;
  }
  const std::vector<int> leaders = group_leaders(model);
  const auto zero_posture =
      forward_kinematics(model, Isometry3d::Identity(), std::vector<double>(model.joints.size(), 0.0));
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Link& link = model.links[i];
    if (leaders[i] != static_cast<int>(i) || (i == 0 && root_is_fixed(description))) continue;
    const Inertial inertial = group_inertial(model, leaders, static_cast<int>(i), zero_posture);
    if (!(inertial.mass > 0.0) || !std::isfinite(inertial.mass))
      findings.push_back(error(body + "link '" + link.name + "' moves but has no mass"));
    else if (!positive_definite(inertial.inertia))
      findings.push_back(error(body + "the inertia of link '" + link.name + "' is not positive definite"));
  }
  for (const Device& device : model.devices) {
    if (!std::holds_alternative<ForceSensor>(device.kind)) continue;
    if (device.link != 0 && model.links[device.link].joint.type == JointType::fixed)
      findings.push_back(error(body + "force sensor '" + device.name + "' sits behind the fixed joint '" +
                                   model.links[device.link].joint.name + "', where no force can be measured",
                               "put it on a link that a revolute or prismatic joint holds"));
  }
  return findings;
}

OdeBody::OdeBody(dWorldID world, WorldBody description, double time_step)
    : description_(std::move(description)), time_step_(time_step) {
  const Model& model = *description_.model;
  Isometry3d root = Isometry3d::Identity();
  root.linear() = description_.rotation.toRotationMatrix();
  root.translation() = description_.position;
  const auto zero_posture = forward_kinematics(model, root, std::vector<double>(model.joints.size(), 0.0));

  group_links();
  create_groups(world, zero_posture);
  create_joints(world, zero_posture);  // ODE's joint angles are zero where the joint was made
  create_geoms();
  set_posture(forward_kinematics(model, root, description_.joints));
}

OdeBody::~OdeBody() {
  for (dGeomID geom : geoms_) dGeomDestroy(geom);  // bodies and joints go with the ODE world
}

void OdeBody::group_links() {
  const Model& model = *description_.model;
  const std::vector<int> leaders = group_leaders(model);
  links_.resize(model.links.size());
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    links_[i].leads_group = leaders[i] == static_cast<int>(i);
    if (links_[i].leads_group) {
      links_[i].group = static_cast<int>(groups_.size());
      groups_.emplace_back().first_link = static_cast<int>(i);
    } else {
      links_[i].group = links_[leaders[i]].group;
      links_[i].in_group = links_[model.links[i].parent].in_group * model.links[i].joint.origin;
      links_[i].rotation_in_group = Quaterniond(links_[i].in_group.linear()).normalized();
    }
  }
}

void OdeBody::create_groups(dWorldID world, const std::vector<Isometry3d>& zero_posture) {
  const Model& model = *description_.model;
  const std::vector<int> leaders = group_leaders(model);
  for (RigidGroup& group : groups_) {
    const Isometry3d& frame = zero_posture[group.first_link];
    group.fixed_pose = frame;
    if (group.first_link == 0 && root_is_fixed(description_)) continue;
    const Inertial inertial = group_inertial(model, leaders, group.first_link, zero_posture);
    group.center = inertial.center;
    group.body = dBodyCreate(world);
    const Matrix3d& i = inertial.inertia;
    dMass mass;
    dMassSetParameters(&mass, inertial.mass, 0.0, 0.0, 0.0, i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2));
    dBodySetMass(group.body, &mass);
  }
  set_posture(zero_posture);
}

void OdeBody::create_joints(dWorldID world, const std::vector<Isometry3d>& zero_posture) {
  const Model& model = *description_.model;
  joints_.resize(model.joints.size());
  efforts_.assign(model.joints.size(), 0.0);
  joint_accelerations_.assign(model.joints.size(), 0.0);
  wrenches_.assign(model.devices.size(), Eigen::Matrix<double, 6, 1>::Zero());
  for (std::size_t id = 0; id < model.joints.size(); ++id) {
    OdeJoint& joint = joints_[id];
    joint.link = model.joints[id];
    const Link& link = model.links[joint.link];
    REHEARSE_ASSERT(moves_freely(link.joint), "only movable joints have an id");
    joint.revolute = link.joint.type != JointType::prismatic;
    const dBodyID child = groups_[links_[joint.link].group].body;
    const dBodyID parent = groups_[links_[link.parent].group].body;
    const Vector3d anchor = zero_posture[joint.link].translation();
    const Vector3d axis = zero_posture[joint.link].linear() * link.joint.axis;
    if (joint.revolute) {
      joint.joint = dJointCreateHinge(world, nullptr);
      dJointAttach(joint.joint, child, parent);
      dJointSetHingeAnchor(joint.joint, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(joint.joint, axis.x(), axis.y(), axis.z());
    } else {
      joint.joint = dJointCreateSlider(world, nullptr);
      dJointAttach(joint.joint, child, parent);
      dJointSetSliderAxis(joint.joint, axis.x(), axis.y(), axis.z());
    }
  }
  for (const Device& device : model.devices) {
    if (!std::holds_alternative<ForceSensor>(device.kind) || device.link == 0) continue;
    OdeJoint& joint = joints_[model.links[device.link].joint.id];
    if (joint.feedback) continue;
    joint.feedback = std::make_unique<dJointFeedback>();
    dJointSetFeedback(joint.joint, joint.feedback.get());
  }
}

dGeomID OdeBody::create_geom(const Geometry& geometry) const {
  struct Maker {
    dGeomID operator()(const Box& box) const { return dCreateBox(nullptr, box.size.x(), box.size.y(), box.size.z()); }
    dGeomID operator()(const Sphere& sphere) const { return dCreateSphere(nullptr, sphere.radius); }
    dGeomID operator()(const Cylinder& c) const { return dCreateCylinder(nullptr, c.radius, c.length); }
    dGeomID operator()(const Capsule& c) const { return dCreateCapsule(nullptr, c.radius, c.length); }
  };
  return std::visit(Maker{}, geometry);
}

void OdeBody::create_geoms() {
  const Model& model = *description_.model;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const RigidGroup& group = groups_[links_[i].group];
    for (const Shape& shape : model.links[i].collisions) {
      const dGeomID geom = create_geom(shape.geometry);
      const Isometry3d in_group = links_[i].in_group * shape.pose;
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
      geoms_.push_back(geom);
    }
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
  for (std::size_t id = 0; id < joints_.size(); ++id) {
    OdeJoint& joint = joints_[id];
    if (!joint.joint || !joint.revolute) continue;
    joint.wrapped = dJointGetHingeAngle(joint.joint);
    joint.turns = static_cast<int>(std::lround((description_.joints[id] - joint.wrapped) / (2.0 * std::numbers::pi)));
  }
}

double OdeBody::displacement(const OdeJoint& joint) const {
  return joint.revolute ? joint.wrapped + 2.0 * std::numbers::pi * joint.turns : dJointGetSliderPosition(joint.joint);
}

double OdeBody::rate(const OdeJoint& joint) const {
  return joint.revolute ? dJointGetHingeAngleRate(joint.joint) : dJointGetSliderPositionRate(joint.joint);
}

void OdeBody::set_motor(OdeJoint& joint, double velocity, double limit) {
  const auto set = joint.revolute ? dJointSetHingeParam : dJointSetSliderParam;
  if (limit <= 0.0) {
    if (joint.motor_on) set(joint.joint, dParamFMax, 0.0);
    joint.motor_on = false;
    return;
  }
  set(joint.joint, dParamFMax, std::isfinite(limit) ? limit : dInfinity);
  set(joint.joint, dParamVel, velocity);
  joint.motor_on = true;
  if (!joint.feedback) {
    joint.feedback = std::make_unique<dJointFeedback>();
    dJointSetFeedback(joint.joint, joint.feedback.get());
  }
}

void OdeBody::apply_effort(const OdeJoint& joint, double effort) {
  if (joint.revolute)
    dJointAddHingeTorque(joint.joint, effort);
  else
    dJointAddSliderForce(joint.joint, effort);
}

void OdeBody::drive(const BodyCommand& command) {
  const Model& model = *description_.model;
  REHEARSE_ASSERT(command.joints.size() == joints_.size(), "a command has an entry for each joint");
  for (std::size_t id = 0; id < joints_.size(); ++id) {
    OdeJoint& joint = joints_[id];
    const JointCommand& wanted = command.joints[id];
    const Joint& limits = model.links[joint.link].joint;
    REHEARSE_ASSERT(std::isfinite(wanted.q) && std::isfinite(wanted.dq) && std::isfinite(wanted.u),
                    "commands are finite when they reach the world");
    joint.applied = limits.damping > 0.0 ? -limits.damping * rate(joint) : 0.0;
    efforts_[id] = 0.0;
    // displacement over velocity over effort, as Choreonoid's MuJoCo item ranks them
    if (wanted.drive & drive_displacement) {
      const double velocity = (wanted.q - displacement(joint)) / time_step_;
      set_motor(joint, std::clamp(velocity, -limits.velocity, limits.velocity), limits.effort);
    } else if (wanted.drive & drive_velocity) {
      set_motor(joint, wanted.dq, limits.effort);
    } else {
      set_motor(joint, 0.0, limits.friction);
      if (wanted.drive & drive_effort) efforts_[id] = wanted.u;
      joint.applied += efforts_[id];
    }
    joint.motor_drives = (wanted.drive & (drive_displacement | drive_velocity)) != 0;
    if (joint.applied != 0.0) apply_effort(joint, joint.applied);
  }
}

void OdeBody::add_wrench(int link, const Vector3d& force, const Vector3d& torque_about_origin) {
  const dBodyID body = groups_[links_[link].group].body;
  if (!body) return;
  const Vector3d torque = torque_about_origin - vector(dBodyGetPosition(body)).cross(force);
  dBodyAddForce(body, force.x(), force.y(), force.z());
  dBodyAddTorque(body, torque.x(), torque.y(), torque.z());
}

Vector3d OdeBody::link_point(int link, const Vector3d& point_in_link) const {
  const RigidGroup& group = groups_[links_[link].group];
  const Vector3d in_group = links_[link].in_group * point_in_link;
  if (!group.body) return group.fixed_pose * in_group;
  return vector(dBodyGetPosition(group.body)) + rotation(dBodyGetRotation(group.body)) * (in_group - group.center);
}

void OdeBody::before_step() {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    group.previous_velocity = vector(dBodyGetLinearVel(group.body));
    group.previous_angular_velocity = vector(dBodyGetAngularVel(group.body));
  }
  for (OdeJoint& joint : joints_) joint.previous_dq = rate(joint);
}

Vector3d OdeBody::world_axis(const OdeJoint& joint) const {
  dVector3 axis;
  if (joint.revolute)
    dJointGetHingeAxis(joint.joint, axis);
  else
    dJointGetSliderAxis(joint.joint, axis);
  return vector(axis);
}

Wrench OdeBody::child_wrench(const OdeJoint& joint) const {
  // The joint's constraint forces on body 1, the child, come from ODE; the torque is about the child's centre of mass.
  // Efforts that were added as external forces are not among them.
  Wrench wrench{vector(joint.feedback->f1), vector(joint.feedback->t1)};
  (joint.revolute ? wrench.torque : wrench.force) += joint.applied * world_axis(joint);
  return wrench;
}

double OdeBody::motor_effort(const OdeJoint& joint) const {
  const Vector3d force = vector(joint.feedback->f1);
  if (!joint.revolute) return world_axis(joint).dot(force);
  // about the hinge, where the forces that only guide the link have no share along the axis
  const Vector3d lever =
      vector(dBodyGetPosition(groups_[links_[joint.link].group].body)) - link_point(joint.link, Vector3d::Zero());
  return world_axis(joint).dot(vector(joint.feedback->t1) + lever.cross(force));
}

void OdeBody::after_step() {
  const Model& model = *description_.model;
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    group.acceleration = (vector(dBodyGetLinearVel(group.body)) - group.previous_velocity) / time_step_;
    group.angular_acceleration =
        (vector(dBodyGetAngularVel(group.body)) - group.previous_angular_velocity) / time_step_;
  }
  for (std::size_t id = 0; id < joints_.size(); ++id) {
    OdeJoint& joint = joints_[id];
    joint_accelerations_[id] = (rate(joint) - joint.previous_dq) / time_step_;
    if (joint.motor_drives) efforts_[id] = motor_effort(joint);
    if (!joint.revolute) continue;
    const double angle = dJointGetHingeAngle(joint.joint);
    if (angle - joint.wrapped > std::numbers::pi) --joint.turns;
    if (angle - joint.wrapped < -std::numbers::pi) ++joint.turns;
    joint.wrapped = angle;
  }
  for (std::size_t i = 0; i < model.devices.size(); ++i) {
    const Device& device = model.devices[i];
    if (!std::holds_alternative<ForceSensor>(device.kind) || device.link == 0) continue;
    const OdeJoint& joint = joints_[model.links[device.link].joint.id];
    const dBodyID child = groups_[links_[device.link].group].body;
    const Wrench wrench = child_wrench(joint);
    const Vector3d lever = vector(dBodyGetPosition(child)) - link_point(device.link, device.pose.translation());
    const Matrix3d to_sensor =
        (rotation(dBodyGetRotation(child)) * links_[device.link].in_group.linear() * device.pose.linear()).transpose();
    // what the child exerts on its parent: the opposite of what the joint does to the child
    wrenches_[i].head<3>() = -(to_sensor * wrench.force);
    wrenches_[i].tail<3>() = -(to_sensor * (wrench.torque + lever.cross(wrench.force)));
  }
}

void OdeBody::observe(BodyObservation& observation, const Vector3d& gravity, bool stepped) const {
  const Model& model = *description_.model;
  observation.joints.resize(joints_.size());
  observation.links.resize(links_.size());
  observation.devices.resize(model.devices.size());
  for (std::size_t id = 0; id < joints_.size(); ++id)
    observation.joints[id] = {displacement(joints_[id]), rate(joints_[id]), joint_accelerations_[id], efforts_[id]};
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const RigidGroup& group = groups_[links_[i].group];
    LinkReading& link = observation.links[i];
    if (!group.body) {
      const Isometry3d pose = group.fixed_pose * links_[i].in_group;
      link.position = pose.translation();
      link.rotation = Quaterniond(pose.linear()).normalized();
      continue;
    }
    const Vector3d arm = rotation(dBodyGetRotation(group.body)) * (links_[i].in_group.translation() - group.center);
    const Vector3d w = vector(dBodyGetAngularVel(group.body));
    link.position = vector(dBodyGetPosition(group.body)) + arm;
    link.rotation = quaternion(dBodyGetQuaternion(group.body));
    if (!links_[i].leads_group) link.rotation = link.rotation * links_[i].rotation_in_group;
    link.velocity = vector(dBodyGetLinearVel(group.body)) + w.cross(arm);
    link.angular_velocity = w;
    link.acceleration = group.acceleration + group.angular_acceleration.cross(arm) + w.cross(w.cross(arm));
    link.angular_acceleration = group.angular_acceleration;
  }
  for (std::size_t i = 0; i < model.devices.size(); ++i) {
    DeviceReading& reading = observation.devices[i];
    if (std::holds_alternative<Camera>(model.devices[i].kind)) continue;
    reading.fresh = stepped;
    if (std::holds_alternative<ForceSensor>(model.devices[i].kind))
      reading.values.assign(wrenches_[i].data(), wrenches_[i].data() + 6);
    else
      measure(model.devices[i], observation, gravity, reading);
    if (!stepped) reading.values.assign(reading.values.size(), 0.0);
  }
}

void OdeBody::measure(const Device& device, const BodyObservation& observation, const Vector3d& gravity,
                      DeviceReading& reading) const {
  const LinkReading& link = observation.links[device.link];
  const Matrix3d to_sensor = (link.rotation.toRotationMatrix() * device.pose.linear()).transpose();
  const Vector3d w = to_sensor * link.angular_velocity;
  // the lever arm of the sensor in its link is ignored, as Choreonoid does
  const Vector3d specific_force = to_sensor * (link.acceleration - gravity);
  if (std::holds_alternative<Gyro>(device.kind)) {
    reading.values.assign(w.data(), w.data() + 3);
  } else if (std::holds_alternative<Accelerometer>(device.kind)) {
    reading.values.assign(specific_force.data(), specific_force.data() + 3);
  } else {
    reading.values.assign(w.data(), w.data() + 3);
    reading.values.insert(reading.values.end(), specific_force.data(), specific_force.data() + 3);
  }
}

bool OdeBody::finite() const {
  for (const RigidGroup& group : groups_) {
    if (!group.body) continue;
    if (!vector(dBodyGetPosition(group.body)).allFinite() || !vector(dBodyGetAngularVel(group.body)).allFinite())
      return false;
  }
  return true;
}

void OdeBody::after_restore() {
  for (RigidGroup& group : groups_) {
    if (!group.body) continue;
    const Vector3d position = vector(dBodyGetPosition(group.body));
    dBodySetPosition(group.body, position.x(), position.y(), position.z());  // its shapes learn that they moved
  }
}

}  // namespace rehearse
