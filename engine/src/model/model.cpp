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
