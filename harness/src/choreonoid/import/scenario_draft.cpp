// Writes a project's run as a scenario for people to read and keep.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "project_run.h"

namespace rehearse::import {
namespace {

constexpr std::size_t widest = 110;   // columns of a line
constexpr const char* belt = "Belt";  // the material of belts, whose friction is the simulator item's
constexpr double least_angle = 1e-9;  // [rad]

std::string vector_text(const Eigen::Vector3d& v) {
  const auto clean = [](double x) { return std::abs(x) < 1e-15 ? 0.0 : x; };
  return fmt::format("[{}, {}, {}]", clean(v.x()), clean(v.y()), clean(v.z()));
}

/// Entries in braces, in as many lines as they need.
std::string wrapped(const std::string& head, const std::vector<std::string>& entries) {
  const std::string indent(head.size() + 1, ' ');
  std::string text, line = head + "{";
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string entry = entries[i] + (i + 1 < entries.size() ? "," : "}");
    const bool is_first = line.ends_with('{');
    if (!is_first && line.size() + 1 + entry.size() > widest) {
      text += line + "\n";
      line = indent + entry;
    } else {
      line += (is_first ? "" : " ") + entry;
    }
  }
  return text + line + "\n";
}

class ScenarioDraft {
 public:
  ScenarioDraft(const ProjectSettings& settings, const ContactMaterials& materials,
                const std::vector<ProjectBody>& bodies)
      : settings_(settings), materials_(materials), bodies_(bodies) {}

  std::string write(const std::string& name, const std::string& project, const std::vector<Attachment>& attachments);

 private:
  void write_run(const std::string& name, const std::string& project);
  void write_solver();
  void write_body(const ProjectBody& body);
  void write_controller(const ProjectController& controller, const std::string& indent);
  void write_materials();
  void line(const std::string& text) { text_ += text + "\n"; }

  /// The material of a link that decides its contacts.
  std::string material_of(const Link& link) const {
    return link.joint.type == JointType::track ? belt : material_name(link.material);
  }
  ContactProperties between(const std::string& a, const std::string& b) const {
    if (a == belt || b == belt) return {settings_.friction, 0.0};
    ContactProperties properties = materials_.between(a, b);
    if (const auto& range = settings_.friction_range)
      properties.friction = std::clamp(properties.friction, range->first, range->second);
    return properties;
  }
  std::set<std::string> used() const;
  bool has_controllers() const {
    return std::ranges::any_of(bodies_, [](const ProjectBody& body) { return !body.controllers.empty(); });
  }

  const ProjectSettings& settings_;
  const ContactMaterials& materials_;
  const std::vector<ProjectBody>& bodies_;
  std::string text_;
};

std::set<std::string> ScenarioDraft::used() const {
  std::set<std::string> names;
  for (const ProjectBody& body : bodies_)
    for (const Link& link : body.model.links) names.insert(material_of(link));
  return names;
}

void ScenarioDraft::write_run(const std::string& name, const std::string& project) {
  const std::string simulator =
      settings_.simulator == nullptr ? "" : fmt::format(", simulator item {}", settings_.simulator->name);
  line(fmt::format("# Imported from {}{}.", project, simulator));
  line("rehearse: 1");
  line(fmt::format("name: {}", yaml_text(name)));
  line(fmt::format("duration: {}    # [s]{}{}", settings_.duration, settings_.why_so_long.empty() ? "" : ", ",
                   settings_.why_so_long));
  if (settings_.time_step != 0.001) line(fmt::format("time_step: {}", settings_.time_step));
  if (settings_.ends_when_done) line("ends_when_done: true    # in the step in which every control() returns false");
  if (settings_.gravity) line(fmt::format("gravity: {}", vector_text(*settings_.gravity)));
  if (settings_.is_planar) line("planar: true    # root links stay in the plane of x and z");
  if (settings_.initial_commands && has_controllers())
    line("initial_commands: true    # what initialize() writes acts in the first step");
  if (!settings_.options.empty())
    line(fmt::format("options: {}    # for every controller", yaml_text(settings_.options)));
  const auto measures_acceleration = [](const ProjectBody& body) {
    return std::ranges::any_of(body.model.devices, [](const Device& device) {
      return std::holds_alternative<Accelerometer>(device.kind) || std::holds_alternative<Imu>(device.kind);
    });
  };
  if (std::ranges::any_of(bodies_, measures_acceleration))
    line("lever_arms: false    # accelerometers measure at their link's origin, as in Choreonoid");
}

void ScenarioDraft::write_solver() {
  line("");
  line("solver:");
  for (const auto& [key, value] : settings_.solver) line(fmt::format("  {}: {}", key, value));
  if (used().contains(belt) && settings_.belt_depth > 0.0)
    line(fmt::format("  belt_depth: {}    # [m]: belts don't drive deeper contacts", settings_.belt_depth));
  line(fmt::format("  friction: {}    # of materials without a pair", between("Default", "Default").friction));
}

void ScenarioDraft::write_controller(const ProjectController& controller, const std::string& indent) {
  line(fmt::format("{}- library: {}", indent, yaml_text(controller.library)));
  if (controller.name != controller.library) line(fmt::format("{}  name: {}", indent, yaml_text(controller.name)));
  if (!controller.options.empty()) line(fmt::format("{}  options: {}", indent, yaml_text(controller.options)));
  if (!controller.delay) line(fmt::format("{}  delay: false", indent));
  if (controller.children.empty()) return;
  line(fmt::format("{}  children:", indent));
  for (const ProjectController& child : controller.children) write_controller(child, indent + "    ");
}

void ScenarioDraft::write_body(const ProjectBody& body) {
  line("");
  line(fmt::format("  - name: {}", yaml_text(body.name)));
  if (body.name != body.item->name) line(fmt::format("    title: {}", yaml_text(body.item->name)));
  line(fmt::format("    model: {}", yaml_text(body.model_file)));
  for (const std::string& option : settings_.model_options) line("    " + option);
  if (body.fixed && !body.is_fixed_by_model) line("    fixed: true");
  if (settings_.is_kinematic) line("    dynamics: kinematic");
  const Eigen::Isometry3d& usual = body.model.links.front().joint.origin;
  if (!body.pose.translation().isZero(0.0) || !usual.translation().isZero(0.0))
    line(fmt::format("    position: {}", vector_text(body.pose.translation())));
  const Eigen::AngleAxisd turn(body.pose.linear());
  if (std::abs(turn.angle()) > least_angle || !usual.linear().isIdentity(0.0))
    line(fmt::format("    rotation: {{axis: {}, angle: {:.10g} deg}}", vector_text(turn.axis()),
                     turn.angle() * 180.0 / std::numbers::pi));
  std::vector<std::string> joints;
  for (const Posture& posture : body.posture)
    joints.push_back(fmt::format("{}: {}", yaml_text(posture.joint), posture.value));
  if (!joints.empty()) text_ += wrapped("    joints: ", joints);
  if (body.has_limits && !settings_.joint_limits) line("    joint_limits: false");
  if (!body.touches) line("    collision: none");
  if (!settings_.is_kinematic) {
    if (body.self_collision && body.touches) line("    self_collision: true");
    if (settings_.limits.efforts && body.has_effort_limits) line("    effort_limits: true");
    if (!settings_.limits.drives && body.has_drive_limits) line("    drive_limits: false");
  }
  if (body.controllers.empty()) return;
  line("    controllers:");
  for (const ProjectController& controller : body.controllers) write_controller(controller, "      ");
}

/// The pairs that differ from the solver's friction, and the names of the links that have none in their models.
void ScenarioDraft::write_materials() {
  const std::set<std::string> names = used();
  const ContactProperties usual{between("Default", "Default").friction, 0.0};
  std::vector<std::tuple<std::string, std::string, ContactProperties>> pairs;
  bool is_default_named = false, is_belt_named = false;
  for (auto a = names.begin(); a != names.end(); ++a) {
    for (auto b = a; b != names.end(); ++b) {
      const ContactProperties properties = between(*a, *b);
      if (properties == usual || (*a == belt && *b == belt)) continue;
      pairs.emplace_back(*a, *b, properties);
      for (const std::string& name : {*a, *b}) {
        is_default_named |= name == "Default";
        is_belt_named |= name == belt;
      }
    }
  }
  if (pairs.empty()) return;
  std::vector<std::string> entries;
  for (const ProjectBody& body : bodies_) {
    const auto& links = body.model.links;
    const bool has_unnamed = std::ranges::any_of(links, [](const Link& link) {
      return link.joint.type != JointType::track && (link.material.empty() || link.material == "default");
    });
    if (is_default_named && has_unnamed) entries.push_back(fmt::format("{}: Default", yaml_text(body.name)));
    for (const Link& link : links)
      if (is_belt_named && link.joint.type == JointType::track)
        entries.push_back(fmt::format("{}: {}", yaml_text(body.name + "/" + link.name), belt));
  }
  line("");
  if (!entries.empty()) text_ += wrapped("materials: ", entries);
  line("pairs:");
  for (const auto& [a, b, properties] : pairs)
    line(fmt::format("  - {{between: [{}, {}], friction: {:.6g}{}}}", yaml_text(a), yaml_text(b), properties.friction,
                     properties.restitution > 0.0 ? fmt::format(", restitution: {:.6g}", properties.restitution) : ""));
}

std::string ScenarioDraft::write(const std::string& name, const std::string& project,
                                 const std::vector<Attachment>& attachments) {
  write_run(name, project);
  write_solver();
  line("");
  text_ += "bodies:";
  std::string head = std::move(text_);
  text_.clear();
  for (const ProjectBody& body : bodies_) write_body(body);
  text_ = head + text_;
  write_materials();
  if (!attachments.empty()) line("\njoints:    # bodies that are attached to others");
  for (const Attachment& attachment : attachments)
    line(fmt::format("  - {{type: fixed, between: [{}, {}]}}", yaml_text(attachment.parent),
                     yaml_text(attachment.child)));
  const bool has_cameras = std::ranges::any_of(bodies_, [](const ProjectBody& body) {
    return std::ranges::any_of(body.model.devices,
                               [](const Device& device) { return std::holds_alternative<Camera>(device.kind); });
  });
  if (has_cameras && !settings_.has_vision)
    line("\ncameras: none    # the project has no vision simulator");
  else if (has_cameras && settings_.cameras)
    line(fmt::format("\ncameras: [{}]", fmt::join(*settings_.cameras, ", ")));
  if (has_controllers()) line("\njoystick: []    # at rest; a project contains no moves of it");
  return std::move(text_);
}

}  // namespace

std::string scenario_text(const std::string& name, const std::string& project, const ProjectSettings& settings,
                          const ContactMaterials& materials, const std::vector<ProjectBody>& bodies,
                          const std::vector<Attachment>& attachments) {
  return ScenarioDraft(settings, materials, bodies).write(name, project, attachments);
}

}  // namespace rehearse::import
