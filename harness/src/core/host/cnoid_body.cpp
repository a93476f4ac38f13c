#include "cnoid_body.h"

#include <cmath>
#include <cnoid/HolderDevice>
#include <cnoid/RotorDevice>
#include <limits>

#include "body_info.h"
#include "core/kinds/kinds.h"
#include "core/kinds/values_device.h"

namespace rehearse {
namespace {

/// In Choreonoid the largest double means "no limit".
double limit(double value) {
  constexpr double largest = std::numeric_limits<double>::max();
  return std::isfinite(value) ? value : std::copysign(largest, value);
}

cnoid::Link::JointType joint_type(const Joint& joint, bool fixed_root) {
  switch (joint.type) {
    case JointType::free: return fixed_root ? cnoid::Link::FixedJoint : cnoid::Link::FreeJoint;
    case JointType::fixed: return cnoid::Link::FixedJoint;
    case JointType::revolute:
    case JointType::continuous: return cnoid::Link::RevoluteJoint;
    case JointType::prismatic: return cnoid::Link::PrismaticJoint;
    case JointType::track: return cnoid::Link::PseudoContinuousTrackJoint;
  }
  return cnoid::Link::FixedJoint;
}

cnoid::LinkPtr make_link(const Link& link, bool fixed) {
  cnoid::LinkPtr made = new cnoid::Link;
  const Joint& joint = link.joint;
  made->setName(link.name);
  made->setJointName(joint.name);
  made->setJointId(joint.controller_id.value_or(joint.id));
  made->setJointType(joint_type(joint, fixed));
  made->setJointAxis(joint.axis);
  made->setOffsetPosition(joint.origin);
  made->setInitialJointDisplacement(joint.start);
  made->setJointRange(limit(joint.lower), limit(joint.upper));
  const auto [slowest, fastest] = joint.velocity_range.value_or(std::array<double, 2>{-joint.velocity, joint.velocity});
  made->setJointVelocityRange(limit(slowest), limit(fastest));
  made->setJointEffortRange(limit(-joint.effort), limit(joint.effort));
  made->setMass(link.inertial.mass);
  made->setCenterOfMass(link.inertial.center);
  made->setInertia(link.inertial.inertia);
  made->setEquivalentRotorInertia(link.joint.armature);
  made->setMaterial(link.material);
  return made;
}

cnoid::DevicePtr make_rotor(const Device& device) {
  const Multicopter::RotorDevicePtr made = new Multicopter::RotorDevice;
  made->setPosition(device.pose.translation());
  made->setDirection(device.pose.linear() * std::get<Rotor>(device.kind).direction);
  return made;
}

cnoid::DevicePtr make_holder(const Holder& holder) {
  const cnoid::HolderDevicePtr made = new cnoid::HolderDevice;
  constexpr cnoid::HolderDevice::HoldCondition conditions[] = {
      cnoid::HolderDevice::Distance, cnoid::HolderDevice::Collision, cnoid::HolderDevice::Name};
  made->setHoldCondition(conditions[static_cast<int>(holder.condition)]);
  made->setMaxHoldDistance(holder.max_distance);
  made->setHoldTargetName(holder.target);
  return made;
}

/// The first function of this name that a kind of the device has; null: none.
template <class Function>
Function first_of_kinds(const Device& device, Function DeviceMeasurement::*function) {
  for (const ChannelKind kind : kinds_of(device))
    if (const Function found = form_of(kind).measurement->*function) return found;
  return nullptr;
}

cnoid::DevicePtr make_device(const Device& device) {
  cnoid::DevicePtr made;
  if (std::holds_alternative<Rotor>(device.kind))
    made = make_rotor(device);
  else if (const auto* holder = std::get_if<Holder>(&device.kind))
    made = make_holder(*holder);
  else if (const auto make = first_of_kinds(device, &DeviceMeasurement::make))
    made = make(device);
  else
    made = new ValuesDevice(std::string(type_name(device)), static_cast<std::size_t>(value_count(device)));
  made->setName(device.name);
  made->setId(device.id);
  made->setLocalPosition(device.pose);
  return made;
}

/// The body is where the model puts it: a frame that the file doesn't give follows from the other one.
cnoid::ExtraJointPtr make_extra_joint(const cnoid::Body& body, const LoopJoint& loop) {
  constexpr cnoid::ExtraJoint::ExtraJointType types[] = {cnoid::ExtraJoint::Fixed, cnoid::ExtraJoint::Hinge,
                                                         cnoid::ExtraJoint::Piston, cnoid::ExtraJoint::Ball};
  cnoid::ExtraJointPtr made = new cnoid::ExtraJoint(types[static_cast<int>(loop.type)], loop.axis);
  cnoid::Link* link = body.link(loop.link);
  cnoid::Link* other = body.link(loop.other_link);
  made->setLink(0, link);
  made->setLocalPosition(0, loop.frame);
  made->setLink(1, other);
  made->setLocalPosition(1, loop.has_other_frame ? loop.other_frame : other->T().inverse() * link->T() * loop.frame);
  return made;
}

}  // namespace

cnoid::BodyPtr make_cnoid_body(const Model& model, const std::string& name, bool fixed) {
  std::vector<cnoid::LinkPtr> links;
  for (const Link& link : model.links) {
    links.push_back(make_link(link, fixed && link.parent < 0));
    if (link.parent >= 0) links[link.parent]->appendChild(links.back());
  }
  cnoid::BodyPtr body = new cnoid::Body(name);
  body->setModelName(model.name);
  body->setRootLink(links[0]);
  for (const Device& device : model.devices) body->addDevice(make_device(device), links[device.link]);
  read_body_info(model, *body->info());
  if (!model.loops.empty()) body->calcForwardKinematics();  // the frames of loops follow from the zero posture
  for (const LoopJoint& loop : model.loops) body->addExtraJoint(make_extra_joint(*body, loop));
  body->initializePosition();
  return body;
}

void set_initial_state(cnoid::Body& body, const Model& model, const BodyObservation& observation) {
  for (std::size_t id = 0; id < observation.joints.size(); ++id)
    body.link(model.joints[id])->q() = observation.joints[id].q;
  for (std::size_t i = 0; i < observation.links.size(); ++i) {
    cnoid::Link* link = body.link(static_cast<int>(i));
    link->T() = pose_of(observation.links[i]);
    link->initializeState();
  }
  body.initializeDeviceStates();
}

FeedFunction device_feed(const Device& device) {
  if (const auto feed = first_of_kinds(device, &DeviceMeasurement::feed)) return feed;
  return [](cnoid::Device& target, const Device&, const DeviceReading& reading, double) {
    target.readState(reading.values.data(), static_cast<int>(reading.values.size()));
  };
}

}  // namespace rehearse
