#include "simulated_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "geoms.h"
#include "initial_motion.h"
#include "link_sensor.h"
#include "model/rigid_groups.h"
#include "ode_math.h"

namespace rehearse {

Eigen::Vector3d Belt::along(const Eigen::Vector3d& normal) const {
  constexpr double least_sine = 1e-3;
  const Eigen::Vector3d direction = axis.cross(normal);
  if (direction.norm() < least_sine) return Eigen::Vector3d::Zero();
  return direction.normalized();
}

namespace {

/// The body whose joints have the limits, rotors and friction of their actuators. Without drive_limits a drive of a
/// joint without an actuator has any velocity.
WorldBody as_built(WorldBody body) {
  if (body.actuators.empty() && body.drive_limits) return body;
  Model model = *body.model;
  for (std::size_t id = 0; id < model.joints.size(); ++id) {
    Joint& joint = model.links[model.joints[id]].joint;
    const Actuator* actuator = body.actuators.empty() || !body.actuators[id] ? nullptr : &*body.actuators[id];
    if (actuator)
      joint = joint_with(*actuator, joint);
    else if (!body.drive_limits)
      joint.velocity = unlimited;
  }
  body.model = std::make_shared<const Model>(std::move(model));
  return body;
}

}  // namespace

SimulatedBody::SimulatedBody(WorldBody description)
    : description_(as_built(std::move(description))), mass_(description_.model->mass()) {
  for (const GroupedLink& link : group_links(*description_.model).links) groups_.push_back(link.group);
  feels_.assign(model().links.size(), false);
  contact_sums_.resize(model().devices.size());
  for (const Device& device : model().devices)
    if (std::holds_alternative<ContactSensor>(device.kind)) feel(device.link);
  const auto acts = [](const Device& device) {
    return std::holds_alternative<Rotor>(device.kind) || std::holds_alternative<Holder>(device.kind);
  };
  if (std::ranges::any_of(model().devices, acts)) acting_devices_.resize(model().devices.size());
}

SimulatedBody::~SimulatedBody() {
  for (const BodyShape& shape : shapes_) dGeomDestroy(shape.geom);  // the world destroys ODE's bodies and joints
}

std::vector<SimulatedBody::AddedGeom> SimulatedBody::add_shape(int link, int collision, int belt) {
  const Shape& shape = model().links[link].collisions[collision];
  std::vector<AddedGeom> geoms;
  for (MadeGeom& made : make_geoms(shape.geometry)) {
    geoms.push_back({made.geom, shape.pose * made.pose});
    shapes_.push_back(
        {made.geom, link, belt, collision, std::move(made.polytope), std::move(made.kept), std::move(made.heightmap)});
  }
  return geoms;
}

void SimulatedBody::feel(int link) {
  feels_[link] = true;
  feels_something_ = true;
}

void SimulatedBody::command(int device, const std::vector<double>& values) {
  const DeviceKind& kind = model().devices.at(device).kind;
  if (std::holds_alternative<Holder>(kind) && !values.empty()) acting_devices_[device].on = values[0];
  constexpr std::size_t rotor_values = 13;  // on, position, direction, thrust and its range, torque and its range
  if (!std::holds_alternative<Rotor>(kind) || values.size() < rotor_values) return;
  const Eigen::Map<const Eigen::Vector3d> position(&values[1]), direction(&values[4]);
  acting_devices_[device] = {values[0], position, direction, values[7], values[10]};
}

void SimulatedBody::apply_rotors() {
  for (std::size_t i = 0; i < acting_devices_.size(); ++i) {
    const Device& device = model().devices[i];
    const ActingDevice& rotor = acting_devices_[i];
    if (!std::holds_alternative<Rotor>(device.kind) || rotor.on == 0.0) continue;
    const Eigen::Vector3d place = link_point(device.link, rotor.position);
    const Eigen::Vector3d direction = link_point(device.link, rotor.position + rotor.direction) - place;
    const Eigen::Vector3d force = rotor.thrust * direction;
    add_wrench(device.link, force, rotor.torque * direction + place.cross(force));
  }
}

void SimulatedBody::visit_acting_devices(StateVisitor& visitor) {
  for (std::size_t i = 0; i < acting_devices_.size(); ++i) {
    const Device& device = model().devices[i];
    if (!std::holds_alternative<Rotor>(device.kind) && !std::holds_alternative<Holder>(device.kind)) continue;
    visitor.begin_part(name(), device.name, StatePart::acting_device);
    ActingDevice& setting = acting_devices_[i];
    visitor.visit(setting.on);
    visitor.visit(setting.position);
    visitor.visit(setting.direction);
    visitor.visit(setting.thrust);
    visitor.visit(setting.torque);
  }
}

void SimulatedBody::watch(int link) {
  watched_.resize(model().links.size(), false);
  watched_[link] = true;
  feel(link);
}

void SimulatedBody::take_touches(std::vector<Touch> touches) {
  touches_ = std::move(touches);
  for (std::size_t i = 0; i < contact_sums_.size(); ++i) {
    const Device& device = model().devices[i];
    const auto* sensor = std::get_if<ContactSensor>(&device.kind);
    if (!sensor) continue;
    contact_sums_[i] = {};
    for (const Touch& touch : touches_) {
      if (touch.link != device.link || (sensor->collision >= 0 && touch.collision != sensor->collision)) continue;
      contact_sums_[i].points += 1.0;
      contact_sums_[i].force += touch.reading.force;
    }
  }
}

void SimulatedBody::read_contact(std::size_t device, const LinkReading& link, double time_step,
                                 std::vector<double>& values) const {
  const Eigen::Matrix3d& in_link = model().devices[device].pose.linear();
  const Eigen::Matrix3d to_sensor = (axes_before(link, time_step) * in_link).transpose();
  const Eigen::Vector3d force = to_sensor * contact_sums_[device].force;
  values.assign({contact_sums_[device].points, force.x(), force.y(), force.z()});
}

void SimulatedBody::visit_contact_sensors(StateVisitor& visitor) {
  for (std::size_t i = 0; i < contact_sums_.size(); ++i) {
    if (!std::holds_alternative<ContactSensor>(model().devices[i].kind)) continue;
    visitor.begin_part(name(), model().devices[i].name, StatePart::contact);
    visitor.visit(contact_sums_[i].points);
    visitor.visit(contact_sums_[i].force);
  }
}

void SimulatedBody::observe_devices(BodyObservation& observation, const WorldSettings& settings, bool stepped) const {
  observation.devices.resize(model().devices.size());
  for (std::size_t i = 0; i < model().devices.size(); ++i) {
    const Device& device = model().devices[i];
    DeviceReading& reading = observation.devices[i];
    if (value_count(device) == 0) continue;
    reading.fresh = stepped;
    const LinkReading& link = observation.links[device.link];
    if (std::holds_alternative<ForceSensor>(device.kind))
      read_force(i, reading.values);
    else if (std::holds_alternative<ContactSensor>(device.kind))
      read_contact(i, link, settings.time_step, reading.values);
    else
      std::visit(LinkSensor(device, link, settings, reading.values), device.kind);
    if (!stepped) reading.values.assign(reading.values.size(), 0.0);
  }
  if (watched_.empty()) return;
  observation.contacts.resize(model().links.size());
  for (std::vector<ContactReading>& contacts : observation.contacts) contacts.clear();
  for (const Touch& touch : touches_)
    if (watched_[touch.link]) observation.contacts[touch.link].push_back(touch.reading);
}

namespace {

/// Errors about missing data for contacts of the body's meshes.
Diagnostics check_meshes(const WorldBody& description, const std::string& body) {
  Diagnostics findings;
  const RigidGroups groups = group_links(*description.model);
  for (std::size_t i = 0; i < description.model->links.size(); ++i) {
    const Link& link = description.model->links[i];
    const bool never_moves = groups.links[i].group == 0 && root_is_fixed(description);
    for (const Shape& shape : link.collisions) {
      const Mesh* mesh = std::get_if<Mesh>(&shape.geometry);
      if (mesh && !mesh->data)
        findings.push_back(error(body + "link '" + link.name + "' has a mesh for its collision that wasn't loaded"));
      else if (mesh && !mesh->hulls && !never_moves)
        findings.push_back(error(body + "link '" + link.name + "' moves, and its mesh has triangles for its collision",
                                 "load the model with UrdfOptions::contact automatic, parts or hull"));
    }
  }
  return findings;
}

/// Errors about impossible numbers of surfaces.
Diagnostics check_surfaces(const WorldBody& description, const std::string& body) {
  constexpr double smallest = std::numeric_limits<double>::min();
  Diagnostics findings;
  for (const Link& link : description.model->links) {
    const Surface& surface = link.surface;
    const auto check = [&](const std::optional<double>& number, const char* name, double least, double most) {
      if (number && !(*number >= least && *number <= most))
        findings.push_back(error(body + "the " + name + " of link '" + link.name + "' is out of its range"));
    };
    check(surface.friction, "friction", 0.0, unlimited);
    check(surface.second_friction, "second friction", 0.0, unlimited);
    check(surface.torsional_friction, "torsional friction", 0.0, std::numeric_limits<double>::max());
    check(surface.rolling_friction, "rolling friction", 0.0, std::numeric_limits<double>::max());
    check(surface.stiffness, "contact stiffness", smallest, std::numeric_limits<double>::max());
    check(surface.damping, "contact damping", 0.0, std::numeric_limits<double>::max());
    check(surface.min_depth, "depth of contacts", 0.0, std::numeric_limits<double>::max());
    check(surface.max_velocity, "correcting velocity", 0.0, unlimited);
    check(surface.restitution, "restitution", 0.0, 1.0);
    check(surface.friction_direction ? std::optional(surface.friction_direction->norm()) : std::nullopt,
          "direction of friction", 0.999, 1.001);
  }
  return findings;
}

}  // namespace

Diagnostics check_dynamics(const WorldBody& description) {
  const Model& model = *description.model;
  const std::string body = "body '" + description.name + "': ";
  Diagnostics findings;
  if (description.joints.size() != model.joints.size()) {
    findings.push_back(error(body + "the model has " + std::to_string(model.joints.size()) + " joints, but " +
                             std::to_string(description.joints.size()) + " initial displacements were given"));
    return findings;
  }
  findings = check_meshes(description, body);
  if (!description.materials.empty() && description.materials.size() != model.links.size())
    findings.push_back(error(body + "the model has " + std::to_string(model.links.size()) + " links, but " +
                             std::to_string(description.materials.size()) + " materials were given"));
  for (Diagnostic& finding : check_velocities(description, body)) findings.push_back(std::move(finding));
  for (Diagnostic& finding : check_surfaces(description, body)) findings.push_back(std::move(finding));
  if (description.kinematic) return findings;
  const RigidGroups groups = group_links(model);
  for (std::size_t i = 0; i < groups.first_links.size(); ++i) {
    if (i == 0 && root_is_fixed(description)) continue;
    const Inertial& inertial = groups.inertials[i];
    const std::string& name = model.links[groups.first_links[i]].name;
    if (!(inertial.mass > 0.0) || !std::isfinite(inertial.mass))
      findings.push_back(error(body + "link '" + name + "' moves but has no mass"));
    else if (!is_positive_definite(inertial.inertia))
      findings.push_back(error(body + "the inertia of link '" + name + "' is not positive definite"));
  }
  return findings;
}

Diagnostics check_mimics(const WorldBody& description) {
  const Model& model = *description.model;
  Diagnostics findings;
  if (description.kinematic) return findings;
  for (const int index : model.joints) {
    const Joint& joint = model.links[index].joint;
    if (!joint.mimic) continue;
    const std::string& leader = model.links[model.joints[joint.mimic->leader]].joint.name;
    findings.push_back(error("body '" + description.name + "': joint '" + joint.name + "' follows '" + leader +
                                 "', which would not feel its load under this method",
                             "use 'method: direct'"));
  }
  return findings;
}

bool root_is_fixed(const WorldBody& description) {
  return description.fixed || description.model->links[0].joint.type == JointType::fixed;
}

}  // namespace rehearse
