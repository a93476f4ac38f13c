#include <rehearse/model.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rehearse {
namespace {

template <class Item>
int find_by_name(const std::vector<Item>& items, std::string_view name) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

Eigen::Isometry3d motion(const Joint& joint, double q) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (joint.type == JointType::prismatic) {
    pose.translation() = q * joint.axis;
  } else {
    pose.linear() = Eigen::AngleAxisd(q, joint.axis).toRotationMatrix();
  }
  return pose;
}

/// Moments about the centre, for a mass of 1 kg.
Eigen::Vector3d unit_moments(const Box& box) {
  const Eigen::Vector3d square = box.size.cwiseAbs2();
  return Eigen::Vector3d(square.y() + square.z(), square.z() + square.x(), square.x() + square.y()) / 12.0;
}

Eigen::Vector3d unit_moments(const Sphere& sphere) {
  return Eigen::Vector3d::Constant(0.4 * sphere.radius * sphere.radius);
}

Eigen::Vector3d unit_moments(const Cylinder& cylinder) {
  const double square = cylinder.radius * cylinder.radius;
  const double across = (3.0 * square + cylinder.length * cylinder.length) / 12.0;
  return {across, across, square / 2.0};
}

Eigen::Vector3d unit_moments(const Capsule& capsule) {
  const double r = capsule.radius;
  const double l = capsule.length;
  // of the volume: the volumes of both are pi r² times a length
  const double caps_share = (4.0 / 3.0) * r / ((4.0 / 3.0) * r + l);
  const Eigen::Vector3d tube = unit_moments(Cylinder{r, l});
  // The centre of a half sphere is 3r/8 from its flat side, which is l/2 from the capsule's centre.
  const double caps_across = 0.4 * r * r + l * l / 4.0 + 3.0 * l * r / 8.0;
  const Eigen::Vector3d caps(caps_across, caps_across, 0.4 * r * r);
  return (1.0 - caps_share) * tube + caps_share * caps;
}

/// Of a mesh: as the box around it.
Eigen::Vector3d unit_moments(const Mesh& mesh) { return unit_moments(Box{mesh.data->upper - mesh.data->lower}); }

}  // namespace

const Texture* texture_of(const MeshPart& part, const Shape& shape) {
  if (part.texture_coordinates.empty()) return nullptr;
  return part.texture ? part.texture.get() : shape.texture.get();
}

Color color_of(const MeshPart& part, const Shape& shape, const Color& otherwise) {
  if (!part.texture && texture_of(part, shape)) return Color::Ones();
  if (part.color && !(part.has_default_color && shape.color)) return *part.color;
  return shape.color.value_or(otherwise);
}

bool is_movable(JointType type) {
  return type == JointType::revolute || type == JointType::continuous || type == JointType::prismatic;
}

bool has_id(JointType type) { return is_movable(type) || type == JointType::track; }

bool is_linear(JointType type) { return type == JointType::prismatic || type == JointType::track; }

std::string_view type_name(JointType type) {
  switch (type) {
    case JointType::free: return "free";
    case JointType::fixed: return "fixed";
    case JointType::revolute: return "revolute";
    case JointType::continuous: return "continuous";
    case JointType::prismatic: return "prismatic";
    case JointType::track: return "track";
  }
  REHEARSE_ASSERT(false, "a JointType outside its enumeration");
}

namespace {

DeviceForm form_of(const DeviceKind& kind) {
  return std::visit([](const auto& of_kind) { return of_kind.form(); }, kind);
}

template <std::size_t... indices>
std::vector<DeviceKind> default_kinds(std::index_sequence<indices...>) {
  return {DeviceKind(std::in_place_index<indices>)...};
}

/// The first kind with that name in the list; nullopt: none.
std::optional<DeviceKind> kind_named(std::string_view name, DeviceNames DeviceForm::*list) {
  for (const DeviceKind& kind : device_kinds())
    if ((form_of(kind).*list).has(name)) return kind;
  return std::nullopt;
}

}  // namespace

std::vector<DeviceKind> device_kinds() {
  std::vector<DeviceKind> kinds = default_kinds(std::make_index_sequence<std::variant_size_v<DeviceKind>>());
  Camera with_depth;
  with_depth.depth = true;
  kinds.emplace_back(with_depth);
  return kinds;
}

std::string_view type_name(const Device& device) { return form_of(device.kind).type; }

std::string_view scenario_type(const DeviceKind& kind) { return form_of(kind).scenario_types.first(); }

std::optional<DeviceKind> device_kind_of_urdf(std::string_view type) {
  return kind_named(type, &DeviceForm::urdf_types);
}

std::optional<DeviceKind> device_kind_of_body(std::string_view type) {
  return kind_named(type, &DeviceForm::body_types);
}

std::vector<MeasuredQuantity> quantities_of(const Device& device) {
  std::vector<MeasuredQuantity> quantities;
  const DeviceForm form = form_of(device.kind);
  for (const MeasuredQuantity& quantity : form.quantities.all())
    if (!quantity.name.empty()) quantities.push_back(quantity);
  return quantities;
}

int value_count(const Device& device) {
  return std::visit([](const auto& kind) { return kind.form().readings.values(); }, device.kind);
}

bool is_actuator(const Device& device) { return form_of(device.kind).readings.acts(); }

std::vector<Eigen::Vector3d> beam_directions(const RangeSensor& sensor) {
  std::vector<Eigen::Vector3d> ahead;  // horizontal direction of each yaw
  for (int i = 0; i < sensor.yaw.samples; ++i) {
    const double yaw = sensor.yaw.angle(i);
    ahead.emplace_back(-std::sin(yaw), 0.0, -std::cos(yaw));
  }
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(static_cast<std::size_t>(sensor.beams()));
  for (int i = 0; i < sensor.pitch.samples; ++i) {
    const double pitch = sensor.pitch.angle(i);
    const double level = std::cos(pitch), up = std::sin(pitch);
    for (const Eigen::Vector3d& direction : ahead)
      directions.emplace_back(level * direction.x(), up, level * direction.z());
  }
  return directions;
}

Light light_of_state(Light light, const std::vector<double>& values) {
  constexpr std::size_t lamp = 8, spot = 14;
  if (values.size() < (light.cone ? spot : lamp)) return light;
  const auto number = [&values](std::size_t i) { return static_cast<float>(values[i]); };
  light.on = values[0] != 0.0;
  light.color = {number(1), number(2), number(3)};
  light.intensity = number(4);
  light.constant = number(5);
  light.linear = number(6);
  light.quadratic = number(7);
  if (!light.cone) return light;
  light.cone->direction = {values[8], values[9], values[10]};
  light.cone->beam_width = number(11);
  light.cone->cut_off_angle = number(12);
  light.cone->cut_off_exponent = number(13);
  return light;
}

int Model::find_link(std::string_view link_name) const { return find_by_name(links, link_name); }

int Model::find_joint(std::string_view joint_name) const {
  for (std::size_t i = 1; i < links.size(); ++i) {
    if (links[i].joint.name == joint_name) return static_cast<int>(i);
  }
  return find_link(joint_name);
}

int Model::find_device(std::string_view device_name) const { return find_by_name(devices, device_name); }

double Model::mass() const {
  double sum = 0.0;
  for (const Link& link : links) sum += link.inertial.mass;
  return sum;
}

Model single_shape_model(std::string name, const Geometry& geometry, double mass, std::optional<Color> color) {
  Shape shape;
  shape.geometry = geometry;
  Link link;
  link.name = name;
  link.inertial = solid_inertial(geometry, mass);
  link.collisions.push_back(shape);
  shape.color = color;
  link.visuals.push_back(std::move(shape));

  Model model;
  model.name = std::move(name);
  model.links.push_back(std::move(link));
  return model;
}

Inertial solid_inertial(const Geometry& geometry, double mass) {
  Inertial inertial;
  inertial.mass = mass;
  const Eigen::Vector3d moments = std::visit([](const auto& shape) { return unit_moments(shape); }, geometry);
  inertial.inertia = (mass * moments).asDiagonal();
  return inertial;
}

std::vector<Eigen::Isometry3d> forward_kinematics(
    const Model& model, const Eigen::Isometry3d& root, const std::vector<double>& q,
    const std::function<Eigen::Isometry3d(std::size_t, const Eigen::Isometry3d&)>& free_pose) {
  REHEARSE_ASSERT(q.size() == model.joints.size(), "forward_kinematics needs one displacement a joint id");
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(model.links.size());
  for (const Link& link : model.links) {
    if (link.parent < 0) {
      poses.push_back(root);
      continue;
    }
    Eigen::Isometry3d pose = poses[static_cast<std::size_t>(link.parent)] * link.joint.origin;
    if (is_movable(link.joint.type)) pose = pose * motion(link.joint, q[static_cast<std::size_t>(link.joint.id)]);
    if (link.joint.type == JointType::free && free_pose) pose = free_pose(poses.size(), pose);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace rehearse
