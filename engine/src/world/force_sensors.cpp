#include "force_sensors.h"

#include <ode/ode.h>

#include <variant>

#include "ode_math.h"

namespace rehearse {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

ForceSensors::ForceSensors(const Model& model, const RigidGroups& groups, const std::function<OdeJoint&(int id)>& joint)
    : links_(groups.links), wrenches_(model.devices.size(), Eigen::Matrix<double, 6, 1>::Zero()) {
  for (std::size_t i = 0; i < model.devices.size(); ++i) {
    const Device& device = model.devices[i];
    if (!std::holds_alternative<ForceSensor>(device.kind) || !has_joint(model, device.link)) continue;
    motions_.resize(groups.first_links.size());
    if (links_[device.link].leads_group) {
      OdeJoint& measured = joint(model.links[device.link].joint.id);
      measured.measure_wrench();
      joint_sensors_.push_back({i, &measured});
      continue;
    }
    CutSensor& cut = cuts_.emplace_back();
    cut.device = i;
    cut.part = part_behind(model, groups, device.link);
    for (std::size_t link = 1; link < model.links.size(); ++link) {
      const Link& other = model.links[link];
      if (cut.part.holds[link]) feeling_links_.push_back(static_cast<int>(link));
      if (!is_movable(other.joint.type) || !cut.part.holds[other.parent]) continue;
      OdeJoint& child = joint(other.joint.id);
      child.measure_wrench();
      cut.children.push_back({static_cast<int>(link), &child});
    }
  }
}

void ForceSensors::begin_step(const std::vector<RigidGroup>& groups) {
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const RigidGroup& group = groups[i];
    GroupMotion& motion = motions_[i];
    motion.frame = group.fixed_pose;
    if (!group.body) continue;
    motion.center = vector(dBodyGetPosition(group.body));
    motion.angular_velocity = group.previous_angular_velocity;
    motion.frame.linear() = rotation(dBodyGetRotation(group.body));
    motion.frame.translation() = motion.center - motion.frame.linear() * group.center;
  }
}

void ForceSensors::add_wrench(int link, const Vector3d& force, const Vector3d& torque) {
  for (CutSensor& cut : cuts_) {
    if (!cut.part.holds[link]) continue;
    cut.external.force += force;
    cut.external.torque += torque;
  }
}

void ForceSensors::measure(const Model& model, const std::vector<RigidGroup>& groups, const std::vector<Touch>& touches,
                           const Vector3d& gravity) {
  for (const JointSensor& sensor : joint_sensors_) measure_joint(sensor, model.devices[sensor.device]);
  for (CutSensor& cut : cuts_) {
    const Device& device = model.devices[cut.device];
    measure_cut(cut, device, groups[static_cast<std::size_t>(links_[device.link].group)], touches, gravity);
    cut.external = {};
  }
}

/// The joint's force acts at the poses of the step's beginning.
void ForceSensors::measure_joint(const JointSensor& of, const Device& device) {
  const GroupMotion& child = motion_of(device.link);
  const Wrench wrench = of.joint->child_wrench();
  const Isometry3d sensor = child.frame * links_[device.link].in_group * device.pose;
  const Vector3d lever = child.center - sensor.translation();
  const Matrix3d to_sensor = sensor.linear().transpose();
  // the wrench of the child on its parent: the opposite of the joint's wrench on the child
  wrenches_[of.device].head<3>() = -(to_sensor * wrench.force);
  wrenches_[of.device].tail<3>() = -(to_sensor * (wrench.torque + lever.cross(wrench.force)));
}

void ForceSensors::measure_cut(const CutSensor& cut, const Device& device, const RigidGroup& group,
                               const std::vector<Touch>& touches, const Vector3d& gravity) {
  GroupMotion motion = motion_of(device.link);
  motion.acceleration = group.acceleration;
  motion.angular_acceleration = group.angular_acceleration;
  const Isometry3d sensor = motion.frame * links_[device.link].in_group * device.pose;
  const Vector3d origin = sensor.translation();
  // other wrenches on the part than that of the cut
  Vector3d force = cut.external.force;
  Vector3d torque = cut.external.torque - origin.cross(cut.external.force);
  for (const Touch& touch : touches) {
    if (!cut.part.holds[touch.link]) continue;
    force += touch.reading.force;
    torque += (touch.reading.position - origin).cross(touch.reading.force);
  }
  for (const CutSensor::Child& child : cut.children) {
    const Wrench on_child = child.joint->child_wrench();
    const Vector3d arm = motion_of(child.link).center - origin;
    force -= on_child.force;
    torque -= on_child.torque + arm.cross(on_child.force);
  }
  // the cut transmits the rest of the wrench that the part needs; the part exerts the opposite
  const Wrench needed = wrench_to_move(cut.part, motion, gravity, origin);
  const double factor = group.factor;
  wrenches_[cut.device].head<3>() = sensor.linear().transpose() * (force - factor * needed.force);
  wrenches_[cut.device].tail<3>() = sensor.linear().transpose() * (torque - factor * needed.torque);
}

void ForceSensors::read(std::size_t device, std::vector<double>& values) const {
  values.assign(wrenches_[device].data(), wrenches_[device].data() + 6);
}

void ForceSensors::visit_state(const std::string& body, const Model& model, StateVisitor& visitor) {
  for (std::size_t device = 0; device < wrenches_.size(); ++device) {
    visitor.begin_part(body, model.devices[device].name, StatePart::wrench);
    visitor.visit(wrenches_[device].data(), 6 * sizeof(double));
  }
}

}  // namespace rehearse
