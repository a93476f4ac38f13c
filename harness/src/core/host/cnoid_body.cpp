#include "cnoid_body.h"

#include "model/pinhole.h"

#include <cmath>
#include <cnoid/AccelerationSensor>
#include <cnoid/ForceSensor>
#include <cnoid/HolderDevice>
#include <cnoid/Imu>
#include <cnoid/RangeCamera>
#include <cnoid/RangeSensor>
#include <cnoid/RateGyroSensor>
#include <cnoid/RotorDevice>
#include <cnoid/SpotLight>
#include <limits>

#include "contact_device.h"

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
  made->setJointRange(limit(joint.lower), limit(joint.upper));
  made->setJointVelocityRange(limit(-joint.velocity), limit(joint.velocity));
  made->setJointEffortRange(limit(-joint.effort), limit(joint.effort));
  made->setMass(link.inertial.mass);
  made->setCenterOfMass(link.inertial.center);
  made->setInertia(link.inertial.inertia);
  made->setEquivalentRotorInertia(link.joint.armature);
  return made;
}

cnoid::DevicePtr make_camera(const Camera& camera) {
  cnoid::CameraPtr made = camera.depth ? new cnoid::RangeCamera : new cnoid::Camera;
  made->setImageType(cnoid::Camera::COLOR_IMAGE);
  made->setResolution(camera.width, camera.height);
  made->setFieldOfView(camera.field_of_view);
  made->setNearClipDistance(camera.near_clip);
  made->setFarClipDistance(camera.far_clip);
  made->setFrameRate(camera.frame_rate);
  return made;
}

cnoid::DevicePtr make_range_sensor(const RangeSensor& sensor) {
  cnoid::RangeSensorPtr made = new cnoid::RangeSensor;
  made->setYawRange(sensor.yaw.lower, sensor.yaw.upper);
  made->setNumYawSamples(sensor.yaw.samples);
  made->setPitchRange(sensor.pitch.lower, sensor.pitch.upper);
  made->setNumPitchSamples(sensor.pitch.samples);
  made->setMinDistance(sensor.min_distance);
  made->setMaxDistance(sensor.max_distance);
  made->setScanRate(sensor.scan_rate);
  return made;
}

cnoid::DevicePtr make_light(const Light& light) {
  cnoid::PointLightPtr made;
  if (light.cone) {
    const cnoid::SpotLightPtr spot = new cnoid::SpotLight;
    spot->setDirection(light.cone->direction);
    spot->setBeamWidth(light.cone->beam_width);
    spot->setCutOffAngle(light.cone->cut_off_angle);
    spot->setCutOffExponent(light.cone->cut_off_exponent);
    made = spot;
  } else {
    made = new cnoid::PointLight;
  }
  made->on(light.on);
  made->setColor(light.color);
  made->setIntensity(light.intensity);
  made->setConstantAttenuation(light.constant);
  made->setLinearAttenuation(light.linear);
  made->setQuadraticAttenuation(light.quadratic);
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

cnoid::DevicePtr make_device(const Device& device) {
  struct Maker {
    const Device& device;
    cnoid::DevicePtr operator()(const ForceSensor&) const { return new cnoid::ForceSensor; }
    cnoid::DevicePtr operator()(const Gyro&) const { return new cnoid::RateGyroSensor; }
    cnoid::DevicePtr operator()(const Accelerometer&) const { return new cnoid::AccelerationSensor; }
    cnoid::DevicePtr operator()(const Imu&) const { return new cnoid::Imu; }
    cnoid::DevicePtr operator()(const Camera& camera) const { return make_camera(camera); }
    cnoid::DevicePtr operator()(const RangeSensor& sensor) const { return make_range_sensor(sensor); }
    cnoid::DevicePtr operator()(const Light& light) const { return make_light(light); }
    cnoid::DevicePtr operator()(const ContactSensor&) const { return new ContactDevice; }
    cnoid::DevicePtr operator()(const Rotor&) const { return make_rotor(device); }
    cnoid::DevicePtr operator()(const Holder& holder) const { return make_holder(holder); }
  };
  cnoid::DevicePtr made = std::visit(Maker{device}, device.kind);
  made->setName(device.name);
  made->setId(device.id);
  made->setLocalPosition(device.pose);
  return made;
}

void feed_camera(cnoid::Camera& target, const Camera& camera, const DeviceReading& reading, double delivered_at) {
  if (!reading.image) {
    target.clearState();
    return;
  }
  const auto image = std::make_shared<cnoid::Image>();
  image->setSize(reading.image->width, reading.image->height, 3);
  std::copy(reading.image->pixels.begin(), reading.image->pixels.end(), image->pixels());
  std::shared_ptr<cnoid::Image> handed = image;
  target.setImage(handed);
  target.setDelay(delivered_at - reading.measured_at);
  auto* range_camera = dynamic_cast<cnoid::RangeCamera*>(&target);
  if (!range_camera || !reading.depth) return;
  auto points = std::make_shared<cnoid::RangeCamera::PointData>();
  points_from_depth(camera, *reading.depth, *points);
  range_camera->setPoints(points);
}

void feed_range_sensor(cnoid::RangeSensor& target, const DeviceReading& reading, double delivered_at) {
  if (!reading.ranges) {
    target.clearState();
    return;
  }
  auto ranges = std::make_shared<cnoid::RangeSensor::RangeData>(reading.ranges->begin(), reading.ranges->end());
  target.setRangeData(ranges);
  target.setDelay(delivered_at - reading.measured_at);
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

void feed_device(cnoid::Device& target, const Device& device, const DeviceReading& reading, double delivered_at) {
  if (const auto* camera = std::get_if<Camera>(&device.kind))
    feed_camera(static_cast<cnoid::Camera&>(target), *camera, reading, delivered_at);
  else if (std::holds_alternative<RangeSensor>(device.kind))
    feed_range_sensor(static_cast<cnoid::RangeSensor&>(target), reading, delivered_at);
  else
    target.readState(reading.values.data(), static_cast<int>(reading.values.size()));
}

}  // namespace rehearse
