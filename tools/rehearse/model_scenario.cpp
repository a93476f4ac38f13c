#include "model_scenario.h"

#include <fmt/format.h>
#include <rehearse/urdf.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "model/shape_bounds.h"

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

/// The height of the root link at which the lowest point of all collision shapes is on the floor [m].
double standing_height(const Model& model) {
  const auto links = forward_kinematics(model, Eigen::Isometry3d::Identity(), rest_posture(model));
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < links.size(); ++i)
    for (const Shape& shape : model.links[i].collisions) box.extend(bounds(shape.geometry, links[i] * shape.pose));
  return box.isEmpty() ? 0.0 : -box.min().z() - depth;
}

std::string joints_text(const Model& model) {
  std::string text;
  const std::vector<double> posture = rest_posture(model);
  for (std::size_t id = 0; id < posture.size(); ++id)
    if (posture[id] != 0.0)
      text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", quoted(model.links[model.joints[id]].joint.name),
                          posture[id]);
  return text.empty() ? "" : fmt::format("    joints: {{{}}}    # nearest to 0 within their limits\n", text);
}

}  // namespace

std::vector<double> rest_posture(const Model& model) {
  std::vector<double> q;
  for (const int link : model.joints) {
    const Joint& joint = model.links[link].joint;
    q.push_back(std::clamp(0.0, joint.lower, joint.upper));
  }
  return q;
}

Result<std::string> scenario_text(const ModelScenario& settings, const std::string& model_file) {
  const Result<Model> model = load_urdf(settings.model);
  if (!model) return model.errors();
  std::string text = fmt::format(
      "rehearse: 1\nname: {}\nduration: {}    # [s]\n\nbodies:\n"
      "  - name: Floor\n    box: {{size: [20, 20, 0.2]}}\n    fixed: true\n"
      "    position: [0, 0, -0.1]    # the top is at z = 0\n\n"
      "  - name: {}\n    model: {}\n",
      plain_name(fs::path(settings.model).stem().string()), settings.duration.value_or(usual_duration),
      plain_name(model->name), quoted(model_file));
  if (model->links[0].joint.type != JointType::fixed)
    text +=
        fmt::format("    position: [0, 0, {:.6f}]    # its lowest point touches the floor\n", standing_height(*model));
  text += joints_text(*model);
  if (!settings.controllers.empty()) text += "    controllers:\n";
  for (const std::string& library : settings.controllers) text += fmt::format("      - library: {}\n", quoted(library));
  return text;
}

Result<Scenario> scenario_of_model(const ModelScenario& settings) {
  auto text = scenario_text(settings, settings.model);
  if (!text) return text.errors();
  const auto named = [](const std::string& file, const UrdfOptions& options) { return load_urdf(file, options); };
  return Scenario::parse(*std::move(text), fs::path(settings.model).stem().string() + ".yaml", named);
}

Result<void> save_scenario(const ModelScenario& settings, const std::string& file) {
  std::error_code ignored;
  if (fs::exists(file, ignored))
    return error(fmt::format("there is a file {} already", file), "name a new one, or edit that one");
  const fs::path folder = fs::absolute(file, ignored).parent_path();
  const auto seen_from_there = [&](const std::string& path) {
    return path.find('/') == std::string::npos && !fs::exists(path, ignored)
               ? path
               : fs::absolute(path, ignored).lexically_proximate(folder).string();
  };
  ModelScenario saved = settings;
  for (std::string& library : saved.controllers) library = seen_from_there(library);
  const auto text = scenario_text(saved, seen_from_there(settings.model));
  if (!text) return text.errors();
  std::ofstream stream(file, std::ios::binary);
  stream << *text;
  stream.close();
  if (!stream) return error(fmt::format("can't write {}", file), "is there such a folder, and room in it?");
  return {};
}

}  // namespace rehearse::tool
