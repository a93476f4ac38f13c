#include "vrml_body.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "mesh/vrml_tree.h"
#include "vrml_shapes.h"
#include "yaml_writer.h"

namespace rehearse::body {
namespace {

/// The sensors of OpenHRP, and the devices of a .body that are the same.
struct SensorForm {
  std::string_view type;
  std::string_view device;  // empty: Choreonoid reads it no more than Rehearse
};
constexpr SensorForm sensors[] = {
    {"ForceSensor", "ForceSensor"}, {"Gyro", "RateGyroSensor"},     {"AccelerationSensor", "AccelerationSensor"},
    {"VisionSensor", "Camera"},     {"RangeSensor", "RangeSensor"}, {"SpotLightDevice", "SpotLight"},
    {"PressureSensor", ""},         {"PhotoInterrupter", ""},       {"TorqueSensor", ""},
    {"TactileSensor", ""}};

const SensorForm* sensor_form(const VrmlNode& node) {
  const auto* found = std::ranges::find_if(sensors, [&node](const SensorForm& form) { return form.type == node.type; });
  return found == std::end(sensors) ? nullptr : found;
}

/// A field of a node, and the key of a .body with the same meaning.
struct FieldForm {
  std::string_view field, key;
};
constexpr FieldForm camera_fields[] = {{"fieldOfView", "field_of_view"},
                                       {"frontClipDistance", "near_clip_distance"},
                                       {"backClipDistance", "far_clip_distance"},
                                       {"width", "width"},
                                       {"height", "height"},
                                       {"frameRate", "frame_rate"}};
constexpr FieldForm range_fields[] = {{"scanAngle", "scanAngle"},
                                      {"scanStep", "scanStep"},
                                      {"scanRate", "scan_rate"},
                                      {"minDistance", "min_distance"},
                                      {"maxDistance", "max_distance"}};
constexpr FieldForm light_fields[] = {
    {"attenuation", "attenuation"},   {"beamWidth", "beam_width"}, {"color", "color"},
    {"cutOffAngle", "cut_off_angle"}, {"direction", "direction"},  {"cutOffExponent", "cut_off_exponent"},
    {"intensity", "intensity"}};

template <std::size_t size>
void copy_fields(const VrmlNode& node, const FieldForm (&forms)[size], MapWriter& to) {
  for (const FieldForm& form : forms)
    if (const VrmlValue* value = node.find(std::string(form.field)); value != nullptr && !value->numbers.empty())
      to.add(form.key, value->numbers.size() == 1 ? number_node(value->numbers[0], node.line)
                                                  : numbers_node(value->numbers, node.line));
}

std::string text_of(const VrmlNode& node, const std::string& field) {
  const VrmlValue* value = node.find(field);
  return value == nullptr || value->texts.empty() ? "" : value->texts.front();
}

/// The first number of a list that may be empty.
std::optional<double> first_of(const VrmlNode& node, const std::string& field) {
  const VrmlValue* value = node.find(field);
  if (value == nullptr || value->numbers.empty()) return std::nullopt;
  return value->numbers.front();
}

class BodyWriter {
 public:
  Result<YamlNodePtr> write(const std::vector<VrmlNodePtr>& nodes);

 private:
  using Joints = std::vector<const VrmlNode*>;
  using Elements = std::vector<YamlNodePtr>;

  void write_link(const VrmlNode& joint, const std::string& parent);
  void write_joint_keys(const VrmlNode& joint, MapWriter& link);
  void read_below(const std::vector<VrmlNodePtr>& nodes, bool in_segment, bool is_moved, Elements& elements,
                  Joints& joints);
  void read(const VrmlNode& node, bool in_segment, bool is_moved, Elements& elements, Joints& joints);
  YamlNodePtr segment(const VrmlNode& node);
  YamlNodePtr sensor(const VrmlNode& node, const SensorForm& form, bool in_segment);
  void read_surface(const VrmlNode& node, Elements& elements);
  YamlNodePtr extra_joint(const VrmlNode& node);
  void fail(const VrmlNode& node, std::string message, std::string hint = {});

  std::vector<YamlNodePtr> links_;
  std::optional<Diagnostic> problem_;
};

void BodyWriter::fail(const VrmlNode& node, std::string message, std::string hint) {
  if (problem_) return;
  problem_ = error(std::move(message), std::move(hint));
  problem_->line = node.line;
}

Result<YamlNodePtr> BodyWriter::write(const std::vector<VrmlNodePtr>& nodes) {
  const VrmlNode* humanoid = nullptr;
  std::vector<YamlNodePtr> extra;
  for (const VrmlNodePtr& node : nodes) {
    if (node == nullptr) continue;
    if (node->type == "ExtraJoint") extra.push_back(extra_joint(*node));
    if (node->type != "Humanoid") continue;
    if (humanoid != nullptr) fail(*node, "a second Humanoid; a file describes one body");
    humanoid = node.get();
  }
  if (humanoid == nullptr) {
    problem_ = error("it has no Humanoid: it is a scene, not a body", "name it as a mesh");
    problem_->line = 1;
    return *problem_;
  }
  const std::vector<VrmlNodePtr> roots = children_of(*humanoid);
  if (roots.size() != 1 || roots.front()->type != "Joint") {
    fail(*humanoid, "humanoidBody of the Humanoid isn't one Joint", "the root Joint, which contains all others");
    return *problem_;
  }
  write_link(*roots.front(), "");
  if (problem_) return *problem_;
  MapWriter root(humanoid->line);
  root.add("format", text_node("ChoreonoidBody", 1));
  root.add("formatVersion", text_node("1.0", 1));
  root.add("angleUnit", text_node("radian", 1));
  if (!humanoid->name.empty()) root.add("name", text_node(humanoid->name, humanoid->line));
  root.add("links", list_node(std::move(links_), humanoid->line));
  if (!extra.empty()) root.add("extraJoints", list_node(std::move(extra), humanoid->line));
  return root.node();
}

void BodyWriter::write_link(const VrmlNode& joint, const std::string& parent) {
  if (joint.name.empty()) return fail(joint, "a Joint has no name", "DEF NAME Joint");
  MapWriter link(joint.line);
  link.add("name", text_node(joint.name, joint.line));
  if (!parent.empty()) link.add("parent", text_node(parent, joint.line));
  write_joint_keys(joint, link);
  Elements elements;
  Joints joints;
  read_below(children_of(joint), false, false, elements, joints);
  if (!elements.empty()) link.add("elements", list_node(std::move(elements), joint.line));
  links_.push_back(link.node());
  for (const VrmlNode* child : joints)
    if (!problem_) write_link(*child, joint.name);
}

void BodyWriter::write_joint_keys(const VrmlNode& joint, MapWriter& link) {
  add_pose(joint, link);
  const std::string type = text_of(joint, "jointType");
  link.add("jointType", text_node(type == "rotate" ? "revolute" : type, joint.line));
  if (const auto id = first_of(joint, "jointId"); id && *id >= 0.0) link.add("jointId", number_node(*id, joint.line));
  if (type != "free" && type != "fixed") {
    const std::string letter = text_of(joint, "jointAxis");
    link.add("jointAxis", letter.empty() ? numbers_node(joint.numbers("jointAxis", {0, 0, 1}), joint.line)
                                         : text_node(letter, joint.line));
    for (const auto& [key, lower, upper] :
         {std::tuple("jointRange", "llimit", "ulimit"), std::tuple("jointVelocityRange", "lvlimit", "uvlimit")}) {
      const auto low = first_of(joint, lower), high = first_of(joint, upper);
      if (!low && !high) continue;
      link.add(key, list_node({low ? number_node(*low, joint.line) : text_node("unlimited", joint.line),
                               high ? number_node(*high, joint.line) : text_node("unlimited", joint.line)},
                              joint.line));
    }
  }
  const double whole = first_of(joint, "equivalentInertia").value_or(0.0);
  if (whole != 0.0) link.add("joint_axis_inertia", number_node(whole, joint.line));
  link.add("rotorInertia", number_node(first_of(joint, "rotorInertia").value_or(0.0), joint.line));
  link.add("gearRatio", number_node(first_of(joint, "gearRatio").value_or(1.0), joint.line));
}

void BodyWriter::read_below(const std::vector<VrmlNodePtr>& nodes, bool in_segment, bool is_moved, Elements& elements,
                            Joints& joints) {
  for (const VrmlNodePtr& node : nodes)
    if (node != nullptr && !problem_) read(*node, in_segment, is_moved, elements, joints);
}

/// Shapes belong to a link only within its Segments.
void BodyWriter::read(const VrmlNode& node, bool in_segment, bool is_moved, Elements& elements, Joints& joints) {
  if (node.type == "Joint") {
    if (in_segment || is_moved)
      return fail(
          node, fmt::format("the Joint {} is within a {}", in_quotes(node.name), in_segment ? "Segment" : "Transform"),
          "a Joint is a child of the Joint that carries it");
    joints.push_back(&node);
  } else if (node.type == "Segment") {
    if (in_segment) return fail(node, fmt::format("the Segment {} is within a Segment", in_quotes(node.name)));
    elements.push_back(segment(node));
  } else if (node.type == "Surface") {
    read_surface(node, elements);
  } else if (const SensorForm* form = sensor_form(node)) {
    elements.push_back(sensor(node, *form, in_segment));
  } else if (node.type == "Transform") {
    Elements below;
    read_below(children_of(node), in_segment, true, below, joints);
    if (!below.empty()) elements.push_back(transform_element(node, std::move(below)));
  } else if (node.type == "Shape" || node.type == "Inline") {
    if (YamlNodePtr shape = in_segment ? shape_element(node) : nullptr) elements.push_back(std::move(shape));
  } else {
    read_below(children_of(node), in_segment, is_moved, elements, joints);
  }
}

YamlNodePtr BodyWriter::segment(const VrmlNode& node) {
  MapWriter body(node.line);
  body.add("type", text_node("RigidBody", node.line));
  body.add("centerOfMass", numbers_node(node.numbers("centerOfMass", {0, 0, 0}), node.line));
  body.add("mass", number_node(first_of(node, "mass").value_or(0.0), node.line));
  if (const VrmlValue* inertia = node.find("momentsOfInertia"); inertia != nullptr && !inertia->numbers.empty())
    body.add("inertia", numbers_node(inertia->numbers, node.line));
  Elements elements;
  Joints none;
  read_below(children_of(node), true, false, elements, none);
  if (!elements.empty()) body.add("elements", list_node(std::move(elements), node.line));
  return body.node();
}

/// Separate shapes for looks and for contacts.
void BodyWriter::read_surface(const VrmlNode& node, Elements& elements) {
  for (const auto& [field, type] : {std::pair("visual", "Visual"), std::pair("collision", "Collision")}) {
    Elements below;
    Joints none;
    if (const VrmlValue* nodes = node.find(field)) read_below(nodes->nodes, true, false, below, none);
    MapWriter side(node.line);
    side.add("type", text_node(type, node.line));
    side.add("elements", list_node(std::move(below), node.line));
    elements.push_back(side.node());
  }
}

YamlNodePtr BodyWriter::sensor(const VrmlNode& node, const SensorForm& form, bool in_segment) {
  MapWriter device(node.line);
  device.add("type", text_node(form.device.empty() ? form.type : form.device, node.line));
  if (form.device.empty()) device.add("is_optional", text_node("true", node.line));
  if (!node.name.empty()) device.add("name", text_node(node.name, node.line));
  if (const auto id = first_of(node, "sensorId"); id && *id >= 0.0) device.add("id", number_node(*id, node.line));
  add_pose(node, device);
  if (form.device == "Camera") {
    const std::string format = text_of(node, "type");
    const bool has_depth = format.find("DEPTH") != std::string::npos || format.find("CLOUD") != std::string::npos;
    const bool has_color = format.starts_with("COLOR") || format.starts_with("MONO");
    if (has_color || has_depth)
      device.add("format", text_node(has_color && has_depth ? "COLOR_DEPTH"
                                     : has_depth            ? "DEPTH"
                                                            : "COLOR",
                                     node.line));
    copy_fields(node, camera_fields, device);
  } else if (form.device == "RangeSensor") {
    copy_fields(node, range_fields, device);
  } else if (form.device == "SpotLight") {
    copy_fields(node, light_fields, device);
    device.add("on", text_node(first_of(node, "on").value_or(1.0) != 0.0 ? "true" : "false", node.line));
  }
  Elements below;
  Joints none;
  if (in_segment) read_below(children_of(node), true, false, below, none);
  if (!below.empty()) device.add("elements", list_node(std::move(below), node.line));
  return device.node();
}

YamlNodePtr BodyWriter::extra_joint(const VrmlNode& node) {
  const std::string type = text_of(node, "jointType");
  MapWriter joint(node.line);
  joint.add("jointType", text_node(type == "xyz" ? "ball" : type == "xy" ? "piston" : type, node.line));
  for (const char* key : {"link1Name", "link2Name"}) joint.add(key, text_node(text_of(node, key), node.line));
  for (const char* key : {"link1LocalPos", "link2LocalPos"})
    joint.add(key, numbers_node(node.numbers(key, {0, 0, 0}), node.line));
  joint.add("jointAxis", numbers_node(node.numbers("jointAxis", {1, 0, 0}), node.line));
  return joint.node();
}

}  // namespace

bool is_vrml(std::string_view name, std::string_view text) {
  return name.ends_with(".wrl") || text.starts_with("#VRML");
}

Result<YamlNodePtr> body_of_vrml(std::string_view text) {
  const std::vector<VrmlNodePtr> nodes = REHEARSE_TRY(parse_vrml(text));
  return BodyWriter().write(nodes);
}

}  // namespace rehearse::body
