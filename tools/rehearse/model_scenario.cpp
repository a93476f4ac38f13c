#include "model_scenario.h"

#include <fmt/format.h>
#include <rehearse/body.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "model/shape_bounds.h"
#include "output.h"

namespace rehearse::tool {
namespace {

namespace fs = std::filesystem;

constexpr double usual_duration = 2.0;  // [s]
// penetration of the robot into the floor [m]: so that it touches the floor whatever the rounding
constexpr double depth = 1e-6;

/// A valid name of a body or scenario: letters, digits and underscores.
std::string plain_name(std::string name) {
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return name.empty() ? "Robot" : name;
}

/// Text as YAML's double-quoted string.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

/// The displacements of the joints at the begin.
std::vector<double> posture_of(const ModelScenario& settings, const Model& model) {
  return settings.run ? settings.run->begin.joints : rest_posture(model);
}

/// The height of the root link at which the lowest point of all collision shapes is on the floor [m].
double standing_height(const ModelScenario& settings, const Model& model) {
  Eigen::Isometry3d root = Eigen::Isometry3d::Identity();
  if (settings.run && settings.run->begin.root) root.linear() = settings.run->begin.root->rotation.toRotationMatrix();
  const auto links = forward_kinematics(model, root, posture_of(settings, model));
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const Shape& shape : model.links[i].collisions) box.extend(bounds(shape.geometry, links[i] * shape.pose));
  return box.isEmpty() ? 0.0 : -box.min().z() - depth;
}

std::string joints_text(const ModelScenario& settings, const Model& model) {
  std::string text;
  const std::vector<double> posture = posture_of(settings, model);
  for (std::size_t id = 0; id < posture.size(); ++id)
    if (posture[id] != model.links[model.joints[id]].joint.start &&
        is_movable(model.links[model.joints[id]].joint.type))
      text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", quoted(model.links[model.joints[id]].joint.name),
                          posture[id]);
  return text.empty() ? ""
                      : fmt::format("    joints: {{{}}}    # {}\n", text,
                                    settings.run ? "as in the log" : "nearest to its start within their limits");
}

/// A number within the range of an axis.
double on_axis(const std::string& name, float position) {
  const auto axis = find_control(joystick_axes, name);
  return std::clamp(static_cast<double>(position), lowest_position(axis.value_or(0)), 1.0);
}

std::string joystick_text(const LogStart& begin) {
  if (!begin.has_joystick) return "";
  if (begin.joystick.empty()) return "\njoystick: []\n";
  std::string text = "\njoystick:\n";
  for (const JoystickMove& move : begin.joystick) {
    std::string axes, buttons;
    for (const auto& [name, position] : move.axes)
      axes += fmt::format("{}{}: {}", axes.empty() ? "" : ", ", name, on_axis(name, position));
    for (const auto& [name, pressed] : move.buttons)
      buttons += fmt::format("{}{}: {}", buttons.empty() ? "" : ", ", name, pressed);
    text += fmt::format("  - {{at: {}{}{}}}\n", move.at, axes.empty() ? "" : ", axes: {" + axes + "}",
                        buttons.empty() ? "" : ", buttons: {" + buttons + "}");
  }
  if (begin.moves_left_out > 0)
    text += fmt::format("  # {} more moves of the log are left out\n", begin.moves_left_out);
  return text;
}

/// The comment of the scenario: the data from the log, and the data that no log contains.
std::string heading(const RunOfALog& run) {
  return fmt::format(
      "# Begins as the log {}: the posture of its first tick{}.\n"
      "# Unknown in a log, so not here: pushes and other contacts, the ground (a floor under the lowest point), and\n"
      "# velocities at the begin (the robot is at rest).\n",
      fs::path(run.log).filename().string(), run.begin.has_joystick ? ", its joystick" : "");
}

/// The pose of the root link, and the floor under it.
std::string placed_text(const ModelScenario& settings, const Model& model, std::string& position) {
  const double height = standing_height(settings, model);
  double top = 0.0;
  if (settings.run && settings.run->begin.root) {
    const auto& [p, r] = *settings.run->begin.root;
    top = p.z() - height;
    position = fmt::format("    position: [{}, {}, {}]\n    rotation: {{quaternion: [{}, {}, {}, {}]}}\n", p.x(), p.y(),
                           p.z(), r.w(), r.x(), r.y(), r.z());
  } else if (model.links[0].joint.type != JointType::fixed) {
    position = fmt::format("    position: [0, 0, {:.6f}]    # its lowest point touches the floor\n", height);
  }
  return fmt::format(
      "  - name: Floor\n    box: {{size: [20, 20, 0.2]}}\n    fixed: true\n"
      "    position: [0, 0, {:.6g}]    # the top is at z = {:.6g}\n\n",
      top - 0.1, top);
}

}  // namespace

namespace {

/// The keys of a body for the options of its model.
std::string loading_text(const UrdfOptions& urdf) {
  std::string packages, text;
  for (const auto& [name, folder] : urdf.packages)
    packages += fmt::format("{}{}: {}", packages.empty() ? "" : ", ", quoted(name), quoted(folder.string()));
  if (!packages.empty()) text += fmt::format("    packages: {{{}}}\n", packages);
  if (urdf.default_mass) text += fmt::format("    default_mass: {}\n", *urdf.default_mass);
  if (urdf.allow_missing_meshes) text += "    allow_missing_meshes: true\n";
  if (urdf.mesh_z_up) text += "    mesh_up: z\n";
  if (urdf.allow_unknown_devices) text += "    allow_unknown_devices: true\n";
  if (urdf.allow_unsupported) text += "    allow_unsupported: true\n";
  return text;
}

}  // namespace

std::vector<double> rest_posture(const Model& model) {
  std::vector<double> q;
  for (const int link : model.joints) {
    const Joint& joint = model.links[link].joint;
    q.push_back(std::clamp(joint.start, joint.lower, joint.upper));
  }
  return q;
}

Result<std::string> scenario_text(const ModelScenario& settings, const std::string& model_file) {
  const Model model = REHEARSE_TRY(load_model(settings.model, settings.urdf));
  std::string position;
  const std::string floor = placed_text(settings, model, position);
  std::string text = settings.run ? heading(*settings.run) : "";
  text += fmt::format("rehearse: 1\nname: {}\nduration: {}    # [s]\n",
                      plain_name(fs::path(settings.run ? settings.run->log : settings.model).stem().string()),
                      settings.duration.value_or(usual_duration));
  if (settings.run) text += fmt::format("time_step: {}\n", settings.run->time_step);
  if (!settings.solver.empty()) text += fmt::format("solver: {{method: {}}}\n", settings.solver);
  text += fmt::format("\nbodies:\n{}  - name: {}\n    model: {}\n{}{}{}", floor,
                      settings.run ? settings.run->body : plain_name(model.name), quoted(model_file),
                      loading_text(settings.urdf), position, joints_text(settings, model));
  if (!settings.controllers.empty()) text += "    controllers:\n";
  for (const std::string& library : settings.controllers) text += fmt::format("      - library: {}\n", quoted(library));
  if (!settings.run) return text;
  const MappedController& controller = settings.run->controller;
  if (!controller.name.empty()) text += fmt::format("        name: {}\n", quoted(controller.name));
  if (!controller.options.empty()) text += fmt::format("        options: {}\n", quoted(controller.options));
  if (!controller.delay) text += "        delay: false\n";
  return text + joystick_text(settings.run->begin);
}

Result<Scenario> scenario_of_model(const ModelScenario& settings) {
  auto text = REHEARSE_TRY(scenario_text(settings, settings.model));
  const auto named = [](const std::string& file, const UrdfOptions& options) { return load_model(file, options); };
  return Scenario::parse(std::move(text), fs::path(settings.model).stem().string() + ".yaml", named);
}

Result<void> check_unused(const std::string& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  return error(fmt::format("there is a file {} already", file), "name a new one, or edit that one");
}

Result<void> save_scenario(const ModelScenario& settings, const std::string& file) {
  std::error_code ignored;
  REHEARSE_TRY(check_unused(file));
  const fs::path folder = fs::absolute(file, ignored).parent_path();
  const auto seen_from_there = [&](const std::string& path) {
    return path.find('/') == std::string::npos && !fs::exists(path, ignored)
               ? path
               : fs::absolute(path, ignored).lexically_proximate(folder).string();
  };
  ModelScenario saved = settings;
  for (std::string& library : saved.controllers) library = seen_from_there(library);
  for (auto& [name, package] : saved.urdf.packages)
    package = fs::absolute(package, ignored).lexically_proximate(folder);
  const auto text = REHEARSE_TRY(scenario_text(saved, seen_from_there(settings.model)));
  return write_text(file, text);
}

}  // namespace rehearse::tool
