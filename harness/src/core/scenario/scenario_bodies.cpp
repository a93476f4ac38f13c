#include <rehearse/body.h>

#include "body_forms.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <tuple>

#include "base/names.h"

namespace rehearse {
namespace {

// The keys for the shape of a body; at most one of them may be given.
constexpr std::array<std::string_view, 5> model_keys{"model", "box", "sphere", "cylinder", "heightmap"};

/// The posture of the body's model that its keys name; null: none.
const Posture* find_posture(const Keys& keys, const ScenarioBody& body) {
  const YamlNode* node = keys.find("posture");
  if (node == nullptr) return nullptr;
  for (const Posture& posture : body.model->postures)
    if (posture.name == node->text) return &posture;
  return nullptr;
}

// Reads one body after the other, and each model file once for all bodies with the same settings.
class BodyReader {
 public:
  BodyReader(Findings& findings, const Scenario::ModelSource& source, const Scenario::FileSource& files,
             Scenario& scenario)
      : findings_(findings), source_(source), files_(files), scenario_(scenario) {}

  void read(const YamlNode& node);

 private:
  struct InlineShape {
    std::optional<Geometry> geometry;  // none: it has a mistake
    std::optional<Color> color;
    std::optional<Checker> checker;
  };

  void read_name(const Keys& keys, ScenarioBody& body);
  void read_packages(const YamlNode& node, ScenarioBody& body);
  void check_contact(const Keys& keys, const ScenarioBody& body);
  void read_ground(const Keys& keys, const YamlNode& node, ScenarioBody& body);
  void read_model(const Keys& keys, ScenarioBody& body);
  void refuse_keys_of_a_file(const Keys& keys);
  void read_model_file(const Keys& keys, const YamlNode& node, ScenarioBody& body);
  std::shared_ptr<const Model> load_model(const YamlNode& node, const std::string& file, const UrdfOptions& options);
  InlineShape read_shape(std::string_view kind, const YamlNode& node);
  std::optional<Color> read_color(const YamlNode& node);
  std::optional<Checker> read_checker(const YamlNode& node);
  void make_shape(const Keys& keys, std::string_view kind, const YamlNode& shape, ScenarioBody& body);
  void place_as_model(ScenarioBody& body);
  void check_posture(const Keys& keys, const ScenarioBody& body);
  void check_root(const Keys& keys, ScenarioBody& body);
  void read_velocities(const Keys& keys, ScenarioBody& body);
  std::optional<Surface> read_surface(const Keys& keys);

  Findings& findings_;
  const Scenario::ModelSource& source_;
  const Scenario::FileSource& files_;
  Scenario& scenario_;
  // By file: the packages of its first body.
  std::map<std::string, std::map<std::string, std::filesystem::path>> packages_;
  // by file, fixed, kinematic, default mass, missing meshes, unknown devices, unsupported parts, the meshes' up axis
  // and contact; null: loading failed, and this was reported
  std::map<std::tuple<std::string, bool, bool, std::optional<double>, bool, bool, bool, bool, MeshContact>,
           std::shared_ptr<const Model>>
      models_;
};

void BodyReader::read(const YamlNode& node) {
  const Keys keys(findings_, node, body_form());
  if (!keys.is_map()) return;
  ScenarioBody body;
  body.place = {scenario_.file, node.line, node.column};
  read_name(keys, body);
  bound_body_form().read(keys, body);
  if (const YamlNode* limits = keys.find("effort_limits"); limits != nullptr && body.effort_limits && body.kinematic)
    findings_.warning(*limits, "effort_limits does nothing: the body is kinematic",
                      "a kinematic body takes no efforts");
  if (const YamlNode* limits = keys.find("drive_limits"); limits != nullptr && !body.drive_limits && body.kinematic)
    findings_.warning(*limits, "drive_limits does nothing: the body is kinematic",
                      "a kinematic body reaches its commands in the step");
  if (const YamlNode* packages = keys.find("packages")) read_packages(*packages, body);
  read_model(keys, body);
  if (body.model != nullptr) {
    place_as_model(body);
    check_posture(keys, body);
  }
  if (const YamlNode* belts = keys.find("belts"); belts && body.model) read_belts(findings_, *belts, body);
  const YamlNode* links = keys.find("links");
  if (body.model && links) read_links(findings_, *links, scenario_.solver, body);
  if (body.model) state_links(findings_, links ? *links : keys.absent_map("links"), scenario_.solver, *body.model);
  if (const YamlNode* sensors = keys.find("sensors"); sensors && body.model) read_sensors(findings_, *sensors, body);
  if (const Posture* posture = body.model ? find_posture(keys, body) : nullptr; posture && posture->root) {
    body.position = posture->root->translation();
    body.rotation = Eigen::Quaterniond(posture->root->linear()).normalized();
  }
  keys.read("position", body.position);
  if (const YamlNode* rotation = keys.find("rotation"))
    body.rotation = read_rotation(findings_, *rotation, "rotation").value_or(body.rotation);
  if (body.model != nullptr) {
    check_root(keys, body);
    check_contact(keys, body);
    read_joints(findings_, node, keys.find("joints"), find_posture(keys, body), body);
    read_velocities(keys, body);
    if (const YamlNode* actuators = keys.find("actuators")) read_actuators(findings_, *actuators, body);
  }
  if (const YamlNode* controllers = keys.find("controllers"))
    read_controllers(findings_, *controllers, body, scenario_.file);
  scenario_.bodies.push_back(std::move(body));
}

void BodyReader::check_posture(const Keys& keys, const ScenarioBody& body) {
  const YamlNode* node = keys.find("posture");
  if (node == nullptr || body.model_file.empty() || find_posture(keys, body) != nullptr) return;
  std::vector<std::string> names;
  for (const Posture& posture : body.model->postures) names.push_back(posture.name);
  findings_.error(*node, fmt::format("the model has no posture '{}'", shortened(node->text, 100)),
                  names.empty() ? "a <key name=\"...\" qpos=\"...\"> of a MuJoCo model is one"
                                : name_hint(node->text, names, "postures"));
}

void BodyReader::read_name(const Keys& keys, ScenarioBody& body) {
  const YamlNode* node = keys.require("name", "a name, unique in the scenario");
  if (node == nullptr) return;
  const auto name = rehearse::read_name(findings_, *node, "name");
  if (!name) return;
  body.name = *name;
  body.place = {scenario_.file, node->line, node->column};
  const auto same =
      std::ranges::find_if(scenario_.bodies, [&name](const ScenarioBody& other) { return other.name == *name; });
  if (same != scenario_.bodies.end())
    findings_.error(*node, fmt::format("a second body is named '{}'", *name),
                    fmt::format("the first is in line {}; expected a name of its own", same->place.line));
}

void BodyReader::read_packages(const YamlNode& node, ScenarioBody& body) {
  if (node.kind != YamlNode::Kind::map) {
    expected(findings_, node, "packages", "a map of NAME: DIRECTORY, relative to the scenario");
    return;
  }
  for (const NamedEntry& entry : read_entries(findings_, node)) {
    const auto directory = read_text(findings_, *entry.value, entry.name, "the directory of a package");
    if (directory && directory->empty())
      expected(findings_, *entry.value, entry.name, "the directory of a package, relative to the scenario");
    else if (directory)
      body.packages[entry.name] = *directory;
  }
}

// Called after check_root(), because the model may fix the body.
void BodyReader::check_contact(const Keys& keys, const ScenarioBody& body) {
  if (body.contact.meshes == MeshContact::triangles && !body.fixed)
    findings_.error(*keys.find("collision"),
                    fmt::format("only a fixed body can be touched as triangles, but {} moves", body.name),
                    "expected fixed: true, or collision: parts");
  if (body.self_collision && body.kinematic)
    findings_.warning(*keys.find("self_collision"), "self_collision does nothing: the body is kinematic",
                      "nothing pushes a kinematic body");
  else if (body.self_collision && !body.contact.touches)
    findings_.warning(*keys.find("self_collision"), "self_collision does nothing: the body has no contacts",
                      "collision: none");
}

void BodyReader::read_model(const Keys& keys, ScenarioBody& body) {
  std::string_view chosen;
  for (const NamedEntry& entry : keys.entries()) {
    const auto key = std::ranges::find(model_keys, entry.name);
    if (key == model_keys.end()) continue;
    if (!chosen.empty()) {
      findings_.error(*entry.key, fmt::format("the body has both '{}' and '{}'", chosen, *key),
                      "expected one of model, box, sphere, cylinder, heightmap");
      continue;
    }
    chosen = *key;
    if (chosen == "model") {
      read_model_file(keys, *entry.value, body);
    } else if (chosen == "heightmap") {
      read_ground(keys, *entry.value, body);
    } else {
      make_shape(keys, chosen, *entry.value, body);
    }
  }
  if (!chosen.empty() && chosen != "model") refuse_keys_of_a_file(keys);
  if (chosen.empty()) keys.require("model", "a URDF or .body file, or instead one of box, sphere, cylinder, heightmap");
}

void BodyReader::refuse_keys_of_a_file(const Keys& keys) {
  const std::tuple<std::string_view, const char*, const char*> of_a_file[] = {
      {"packages", "are", "they are the directories of a model's meshes"},
      {"default_mass", "is", "the mass of a shape is stated by mass"},
      {"allow_missing_meshes", "is", "it leaves out the shapes of missing meshes"},
      {"allow_unknown_devices", "is", "it leaves out the devices of a .body that no plugin reads"},
      {"allow_unsupported", "is", "it leaves out what a MuJoCo model has beyond this program"},
      {"posture", "is", "it is one of a model's keyframes"},
      {"mesh_up", "is", "it states the axis that glTF meshes have up"},
  };
  for (const auto& [key, verb, hint] : of_a_file)
    if (const YamlNode* node = keys.find(key))
      findings_.error(*node, fmt::format("{} {} given for a body without a model file", key, verb), hint);
}

void BodyReader::read_model_file(const Keys& keys, const YamlNode& node, ScenarioBody& body) {
  if (const auto file =
          read_text(findings_, node, "model", "the path of a URDF, .body or MuJoCo file, relative to the scenario")) {
    UrdfOptions options;
    options.fixed_root = body.fixed;
    options.kinematic = body.kinematic;
    options.contact = body.contact.meshes;
    model_file_keys().read(keys, options);
    options.packages.insert(body.packages.begin(), body.packages.end());
    body.model_file = *file;
    body.model = load_model(node, *file, options);
  }
  if (const YamlNode* mass = keys.find("mass"))
    findings_.error(*mass, "mass is given for a body with a model file",
                    "the masses of a model are in its file; links: {LINK: {mass: ...}} replaces one");
  for (const char* key : {"friction", "mu2", "fdir1", "restitution"})
    if (const YamlNode* found = keys.find(key))
      findings_.error(*found, fmt::format("{} is given for a body with a model file", key),
                      "the surfaces of a model are in its file: <gazebo reference=\"LINK\"> or <contact>; "
                      "links: {LINK: {friction: ...}} replaces one");
}

std::shared_ptr<const Model> BodyReader::load_model(const YamlNode& node, const std::string& file,
                                                    const UrdfOptions& options) {
  if (packages_.emplace(file, options.packages).first->second != options.packages)
    findings_.error(node, fmt::format("the model '{}' has other packages in a body above", shortened(file, 500)),
                    "a recording contains a model once: give both bodies the same packages");
  const auto [known, is_new] = models_.emplace(
      std::tuple(file, options.fixed_root, options.kinematic, options.default_mass, options.allow_missing_meshes,
                 options.allow_unknown_devices, options.allow_unsupported, options.mesh_z_up, options.contact),
      nullptr);
  if (!is_new) return known->second;
  Result<Model> model = source_(file, options);
  if (!model) {
    const Diagnostic& first = model.errors().front();
    if (first.file.empty()) {
      findings_.error(node, first.message, first.hint);
    } else {
      findings_.error(node, fmt::format("the model '{}' can't be used", shortened(file, 500)),
                      "its own mistakes follow", model.errors());
    }
    return nullptr;
  }
  Diagnostics reports;
  std::ranges::copy_if(model->report, std::back_inserter(reports),
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

// Its squares have the shape's opacity, so the color has no alpha.
std::optional<Checker> BodyReader::read_checker(const YamlNode& node) {
  const Keys keys(findings_, node, checker_form());
  const YamlNode* color = keys.require("color", "[red, green, blue] of every second square");
  Checker checker;
  bound_checker_form().read(keys, checker);
  if (color == nullptr) return std::nullopt;
  const auto values = read_numbers(findings_, *color, "color", 3, 3, {0.0, 1.0});
  if (!values) return std::nullopt;
  checker.color = Eigen::Vector4d((*values)[0], (*values)[1], (*values)[2], 1.0).cast<float>();
  return checker;
}

BodyReader::InlineShape BodyReader::read_shape(std::string_view kind, const YamlNode& node) {
  const Keys keys(findings_, node, kind == "box" ? box_form() : kind == "sphere" ? sphere_form() : cylinder_form());
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
  if (const YamlNode* checker = keys.find("checker")) shape.checker = read_checker(*checker);
  return shape;
}

void BodyReader::make_shape(const Keys& keys, std::string_view kind, const YamlNode& node, ScenarioBody& body) {
  const InlineShape shape = read_shape(kind, node);
  const bool needs_mass = !body.fixed && !body.kinematic;
  const YamlNode* mass_node = needs_mass ? keys.require("mass", "its mass [kg], or fixed: true") : keys.find("mass");
  double mass = 0.0;
  if (mass_node != nullptr) {
    const auto read = read_number(findings_, *mass_node, "mass", any_mass);
    if (!read) return;
    mass = *read;
  } else if (needs_mass) {
    return;
  }
  const std::optional<Surface> surface = read_surface(keys);
  if (!shape.geometry || !surface) return;
  Model model = single_shape_model(body.name, *shape.geometry, mass, shape.color);
  model.links.front().visuals.front().checker = shape.checker;
  model.links.front().surface = *surface;
  body.model = std::make_shared<const Model>(std::move(model));
}

void BodyReader::read_ground(const Keys& keys, const YamlNode& node, ScenarioBody& body) {
  const Keys parts(findings_, node, heightmap_form());
  const YamlNode* file = parts.require("file", "the path of a PNG or of a grid of numbers, relative to the scenario");
  const YamlNode* size = parts.require("size", "the full lengths [x, y] [m]");
  const auto name = file ? read_text(findings_, *file, "file", "the path of a PNG or of a grid") : std::nullopt;
  const auto lengths = size ? read_numbers(findings_, *size, "size", 2, 2, any_length) : std::nullopt;
  HeightmapSettings settings;
  const bool is_picture = name && name->ends_with(".png");
  if (is_picture && parts.require("height", "of white over black [m]") == nullptr) return;
  bound_heightmap_form().read(parts, settings);
  std::optional<Color> color;
  if (const YamlNode* node_of_color = parts.find("color")) color = read_color(*node_of_color);
  for (const char* key : {"mass", "dynamics", "collision"})
    if (const YamlNode* found = keys.find(key))
      findings_.error(*found, fmt::format("{} is given for a heightmap", key), "the ground never moves");
  if (const YamlNode* fixed = keys.find("fixed"); fixed != nullptr && !body.fixed)
    findings_.error(*fixed, "a heightmap can't be free", "the ground never moves");
  body.fixed = true;
  const std::optional<Surface> surface = read_surface(keys);
  if (!name || !lengths || !surface) return;
  settings.size = {(*lengths)[0], (*lengths)[1]};
  const Result<std::string> bytes = files_ ? files_(*name) : error("there is no file '" + shortened(*name) + "'");
  if (!bytes) {
    findings_.error(*file, bytes.errors().front().message, bytes.errors().front().hint);
    return;
  }
  Result<Mesh> ground = read_heightmap(*bytes, *name, settings);
  if (!ground) {
    findings_.error(*file, fmt::format("the heightmap '{}' can't be used", shortened(*name, 500)),
                    "its own mistakes follow", ground.errors());
    return;
  }
  Model model = single_shape_model(body.name, *ground, 0.0, color);
  model.links.front().surface = *surface;
  model.source_file = *name;
  model.source_text = *bytes;
  body.model_file = *name;
  body.model = std::make_shared<const Model>(std::move(model));
}

// The surface of a shape; nothing if it has a mistake.
std::optional<Surface> BodyReader::read_surface(const Keys& keys) {
  Surface surface;
  state_surface(keys, scenario_.solver, surface);
  shape_surface_keys().read(keys, surface);
  const YamlNode* direction = keys.find("fdir1");
  if (direction != nullptr && keys.find("mu2") == nullptr) {
    findings_.error(*direction, "fdir1 is given without mu2", "mu2 is the friction across that direction");
    return std::nullopt;
  }
  if (surface.second_friction) surface.friction_direction = Eigen::Vector3d::UnitX();
  if (direction == nullptr) return surface;
  const auto along = read_vector3(findings_, *direction, "fdir1", {-1e6, 1e6});
  if (along && along->isZero(0.0)) expected(findings_, *direction, "fdir1", "a direction as in [1, 0, 0]");
  if (!along || along->isZero(0.0)) return std::nullopt;
  surface.friction_direction = along->stableNormalized();
  return surface;
}

// Called after check_root(), because the model may fix the body.
void BodyReader::read_velocities(const Keys& keys, ScenarioBody& body) {
  const YamlNode* root = keys.find("velocity");
  const YamlNode* joints = keys.find("joint_velocities");
  for (const auto& [node, key] : {std::pair(root, "velocity"), std::pair(joints, "joint_velocities")})
    if (node != nullptr && body.kinematic)
      findings_.error(*node, fmt::format("{} is given for a kinematic body", key), "its commands move it");
  if (root != nullptr && body.fixed && !body.kinematic)
    findings_.error(*root, fmt::format("velocity is given, but {} is fixed", body.name), "a fixed root never moves");
  if (root != nullptr || !body.fixed) {
    const Keys parts(findings_, root ? *root : keys.absent_map("velocity"), velocity_form());
    bound_velocity_form().read(parts, body);
  }
  if (joints != nullptr) read_joint_velocities(findings_, *joints, body);
}

// Sets the pose and the materials of the model, which the scenario may replace.
void BodyReader::place_as_model(ScenarioBody& body) {
  const std::vector<Link>& links = body.model->links;
  body.position = links.front().joint.origin.translation();
  body.rotation = Eigen::Quaterniond(links.front().joint.origin.linear()).normalized();
  if (std::ranges::none_of(links, [](const Link& link) { return !link.material.empty(); })) return;
  for (const Link& link : links) body.materials.push_back(link.material);
}

// A model may itself be fixed to the world; a scenario can't make it movable.
void BodyReader::check_root(const Keys& keys, ScenarioBody& body) {
  const Link& root = body.model->links.front();
  if (root.joint.type != JointType::fixed) return;
  const YamlNode* fixed = keys.find("fixed");
  if (fixed != nullptr && !body.fixed)
    findings_.warning(*fixed,
                      fmt::format("the model fixes its root link '{}' to the world, so it stays fixed", root.name),
                      root.name == "world" ? "take that link out of the model to set it free"
                                           : "give it an <inertial> to set it free");
  body.fixed = true;
}

}  // namespace

void read_bodies(Findings& findings, const YamlNode& node, const Scenario::ModelSource& models,
                 const Scenario::FileSource& files, Scenario& scenario) {
  const auto list = read_list(findings, node, "bodies", "a list of bodies, each with a name and a model or shape");
  if (node.kind == YamlNode::Kind::list && node.items.empty())
    findings.error(node, "bodies is an empty list", "expected at least one body");
  BodyReader reader(findings, models, files, scenario);
  for (const YamlNodePtr& body : list) reader.read(*body);
}

}  // namespace rehearse
