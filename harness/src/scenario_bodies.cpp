#include <rehearse/urdf.h>

#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>

namespace rehearse {
namespace {

// What the file says a body looks like; at most one of them stands.
constexpr std::array<std::string_view, 4> model_keys{"model", "box", "sphere", "cylinder"};

// Reads one body after the other, and each model file once, however many bodies have it.
class BodyReader {
 public:
  BodyReader(Findings& findings, Scenario& scenario) : findings_(findings), scenario_(scenario) {}

  void read(const YamlNode& node);

 private:
  struct InlineShape {
    std::optional<Geometry> geometry;  // none: it had a mistake
    std::optional<Color> color;
  };

  void read_name(const Keys& keys, ScenarioBody& body);
  void read_model(const Keys& keys, ScenarioBody& body);
  std::shared_ptr<const Model> load_model(const YamlNode& node, const std::string& file);
  InlineShape read_shape(std::string_view kind, const YamlNode& node);
  std::optional<Color> read_color(const YamlNode& node);
  void make_shape(const Keys& keys, std::string_view kind, const YamlNode& shape, ScenarioBody& body);
  void check_root(const Keys& keys, const YamlNode& node, ScenarioBody& body);
  void check_limits(const Keys& keys, const YamlNode& node, const ScenarioBody& body);

  Findings& findings_;
  Scenario& scenario_;
  std::map<std::string, std::shared_ptr<const Model>> models_;  // by file; null: it failed, and that was told
};

void BodyReader::read(const YamlNode& node) {
  const Keys keys(
      findings_, node, "a body",
      {"name", "model", "box", "sphere", "cylinder", "mass", "fixed", "position", "rotation", "joints", "controllers"});
  if (!keys.is_map()) return;
  ScenarioBody body;
  body.place = {scenario_.file, node.line, node.column};
  read_name(keys, body);
  keys.flag("fixed", body.fixed);
  read_model(keys, body);
  keys.vector3("position", any_position, body.position);
  if (const YamlNode* rotation = keys.find("rotation"))
    body.rotation = read_rotation(findings_, *rotation, "rotation").value_or(body.rotation);
  if (body.model != nullptr) {
    check_root(keys, node, body);
    body.joints.assign(body.model->joints.size(), 0.0);
    if (const YamlNode* joints = keys.find("joints")) read_joints(findings_, *joints, body);
    check_limits(keys, node, body);
  }
  if (const YamlNode* controllers = keys.find("controllers"))
    read_controllers(findings_, *controllers, body, scenario_.file);
  scenario_.bodies.push_back(std::move(body));
}

void BodyReader::read_name(const Keys& keys, ScenarioBody& body) {
  const YamlNode* node = keys.require("name", "a name, unique in the scenario");
  if (node == nullptr) return;
  const auto name = rehearse::read_name(findings_, *node, "name");
  if (!name) return;
  body.name = *name;
  body.place = {scenario_.file, node->line, node->column};
  const auto same = std::find_if(scenario_.bodies.begin(), scenario_.bodies.end(),
                                 [&name](const ScenarioBody& other) { return other.name == *name; });
  if (same != scenario_.bodies.end())
    findings_.error(*node, fmt::format("a second body is named '{}'", *name),
                    fmt::format("the first is in line {}; expected a name of its own", same->place.line));
}

void BodyReader::read_model(const Keys& keys, ScenarioBody& body) {
  std::string_view first;
  for (const std::string_view key : model_keys) {
    const YamlNode* node = keys.find(key);
    if (node == nullptr) continue;
    if (!first.empty()) {
      findings_.error(*node, fmt::format("the body has both '{}' and '{}'", first, key),
                      "expected one of model, box, sphere, cylinder");
      continue;
    }
    first = key;
    if (key != "model") {
      make_shape(keys, key, *node, body);
      continue;
    }
    const auto file = read_text(findings_, *node, "model", "the path of a URDF file, relative to the scenario");
    if (file) body.model_file = *file;
    if (file) body.model = load_model(*node, *file);
    if (const YamlNode* mass = keys.find("mass"))
      findings_.error(*mass, "mass is given for a body with a model file", "the masses of a model stand in its file");
  }
  if (first.empty()) keys.require("model", "a URDF file, or instead one of box, sphere, cylinder");
}

std::shared_ptr<const Model> BodyReader::load_model(const YamlNode& node, const std::string& file) {
  const std::filesystem::path path = std::filesystem::path(scenario_.file).parent_path() / file;
  const auto [known, is_new] = models_.emplace(path.lexically_normal().string(), nullptr);
  if (!is_new) return known->second;
  std::error_code ignored;
  if (file.empty() || !std::filesystem::is_regular_file(path, ignored)) {
    findings_.error(node, fmt::format("there is no model file '{}'", file),
                    fmt::format("looked for {}, relative to the scenario", path.string()));
    return nullptr;
  }
  Result<Model> model = load_urdf(path);
  if (!model) {
    findings_.error(node, fmt::format("the model '{}' can't be used", file), "its own mistakes follow", model.errors());
    return nullptr;
  }
  Diagnostics reports;
  std::copy_if(model->report.begin(), model->report.end(), std::back_inserter(reports),
               [](const Diagnostic& report) { return report.severity != Severity::note; });
  findings_.pass_through(node, std::move(reports));
  known->second = std::make_shared<const Model>(std::move(*model));
  return known->second;
}

std::optional<Color> BodyReader::read_color(const YamlNode& node) {
  const auto values = read_numbers(findings_, node, "color", 3, 4, {0.0, 1.0});
  if (!values) return std::nullopt;
  const double opacity = values->size() == 4 ? (*values)[3] : 1.0;
  return Eigen::Vector4d((*values)[0], (*values)[1], (*values)[2], opacity).cast<float>();
}

BodyReader::InlineShape BodyReader::read_shape(std::string_view kind, const YamlNode& node) {
  const auto keys = kind == "box"      ? Keys(findings_, node, "a box", {"size", "color"})
                    : kind == "sphere" ? Keys(findings_, node, "a sphere", {"radius", "color"})
                                       : Keys(findings_, node, "a cylinder", {"radius", "length", "color"});
  const auto length = [this, &keys](std::string_view key) -> std::optional<double> {
    const YamlNode* value = keys.require(key, "a length [m]");
    return value == nullptr ? std::nullopt : read_number(findings_, *value, key, any_length);
  };
  InlineShape shape;
  if (kind == "box") {
    const YamlNode* value = keys.require("size", "the full lengths [x, y, z] [m]");
    const auto size = value == nullptr ? std::nullopt : read_vector3(findings_, *value, "size", any_length);
    if (size) shape.geometry = Box{*size};
  } else if (kind == "sphere") {
    if (const auto radius = length("radius")) shape.geometry = Sphere{*radius};
  } else {
    const auto radius = length("radius");
    const auto height = length("length");
    if (radius && height) shape.geometry = Cylinder{*radius, *height};
  }
  if (const YamlNode* color = keys.find("color")) shape.color = read_color(*color);
  return shape;
}

void BodyReader::make_shape(const Keys& keys, std::string_view kind, const YamlNode& node, ScenarioBody& body) {
  const InlineShape shape = read_shape(kind, node);
  const YamlNode* mass_node = body.fixed ? keys.find("mass") : keys.require("mass", "its mass [kg], or fixed: true");
  double mass = 0.0;
  if (mass_node != nullptr) {
    const auto read = read_number(findings_, *mass_node, "mass", any_mass);
    if (!read) return;
    mass = *read;
  } else if (!body.fixed) {
    return;
  }
  if (!shape.geometry) return;
  body.model = std::make_shared<const Model>(single_shape_model(body.name, *shape.geometry, mass, shape.color));
}

// A model may itself be fixed to the world; a scenario can't free it. And what is free needs a mass to move.
void BodyReader::check_root(const Keys& keys, const YamlNode& node, ScenarioBody& body) {
  const Link& root = body.model->links.front();
  const YamlNode* fixed = keys.find("fixed");
  if (root.joint.type == JointType::fixed) {
    if (fixed != nullptr && !body.fixed)
      findings_.warning(*fixed,
                        fmt::format("the model fixes its root link '{}' to the world, so it stays fixed", root.name),
                        "take the world link out of the model to set it free");
    body.fixed = true;
  }
  if (!body.fixed && !(root.inertial.mass > 0.0))
    findings_.error(fixed != nullptr ? *fixed : node,
                    fmt::format("the body is free but its root link '{}' has no mass", root.name),
                    "give the link an inertial, or say fixed: true");
}

void BodyReader::check_limits(const Keys& keys, const YamlNode& node, const ScenarioBody& body) {
  constexpr double slack = 1e-6;  // [rad] or [m]: -90 deg is not beyond a limit that is written -1.5708
  const YamlNode* joints = keys.find("joints");
  for (std::size_t id = 0; id < body.joints.size(); ++id) {
    const Joint& joint = body.model->links[static_cast<std::size_t>(body.model->joints[id])].joint;
    const double q = body.joints[id];
    if (q >= joint.lower - slack && q <= joint.upper + slack) continue;
    findings_.warning(joints != nullptr ? *joints : node,
                      fmt::format("{} starts at {:.6g}, outside its limits", joint.name, q),
                      fmt::format("they are {:.6g} to {:.6g}", joint.lower, joint.upper));
  }
}

}  // namespace

void read_bodies(Findings& findings, const YamlNode& node, Scenario& scenario) {
  const auto* list = read_list(findings, node, "bodies", "a list of bodies, each with a name and a model or shape");
  if (list == nullptr) return;
  if (list->empty()) findings.error(node, "bodies is an empty list", "expected at least one body");
  BodyReader reader(findings, scenario);
  for (const YamlNodePtr& body : *list) reader.read(*body);
}

}  // namespace rehearse
