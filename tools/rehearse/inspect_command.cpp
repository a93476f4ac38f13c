// rehearse inspect: loads a robot model and prints its contents and findings.
#include <fmt/format.h>
#include <rehearse/body.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"
#include "options.h"
#include "output.h"

namespace rehearse::tool {
namespace {

struct InspectSettings {
  std::string model;
  std::string scenario;  // in place of a model: those of its bodies
  bool json = false;
  UrdfOptions urdf;
};

Json limit_json(double limit) { return std::abs(limit) == unlimited ? Json(nullptr) : number_json(limit); }

/// The joint that a joint with a mimic follows.
const std::string& leader_name(const Model& model, const Mimic& mimic) {
  return model.links[model.joints[mimic.leader]].joint.name;
}

Json mimic_json(const Model& model, const Joint& joint) {
  if (!joint.mimic) return nullptr;
  return {{"joint", leader_name(model, *joint.mimic)},
          {"multiplier", joint.mimic->multiplier},
          {"offset", joint.mimic->offset}};
}

/// `inertia_at_joint`: what the joint feels of the rotor, its inertia times the square of the gear ratio.
Json rotor_json(const Joint& joint) {
  return {{"inertia", joint.rotor_inertia}, {"gear_ratio", joint.gear_ratio}, {"inertia_at_joint", joint.armature}};
}

Json joint_json(const Model& model, const Link& link) {
  const Joint& joint = link.joint;
  return {{"name", joint.name},
          {"type", type_name(joint.type)},
          {"id", joint.id},
          {"parent", model.links[link.parent].name},
          {"child", link.name},
          {"axis", {joint.axis.x(), joint.axis.y(), joint.axis.z()}},
          {"limits",
           {{"lower", limit_json(joint.lower)},
            {"upper", limit_json(joint.upper)},
            {"effort", limit_json(joint.effort)},
            {"velocity", limit_json(joint.velocity)}}},
          {"rotor", rotor_json(joint)},
          {"mimic", mimic_json(model, joint)},
          {"line", joint.line}};
}

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// About the centre of mass, along the link's axes: xx, yy, zz, xy, xz, yz.
Json inertia_json(const Eigen::Matrix3d& m) { return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)}; }

Json quaternion_json(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {q.w(), q.x(), q.y(), q.z()};
}

/// Position and quaternion are those of the link's frame in its parent's with all joints at 0; of the root, in the
/// world. The type of a link is that of its joint to the parent; for the root, that of its joint to the world.
Json links_json(const Model& model) {
  Json links = Json::array();
  for (const Link& link : model.links)
    links.push_back({{"name", link.name},
                     {"type", type_name(link.joint.type)},
                     {"mass", link.inertial.mass},
                     {"center", vector_json(link.inertial.center)},
                     {"inertia", inertia_json(link.inertial.inertia)},
                     {"position", vector_json(link.joint.origin.translation())},
                     {"quaternion", quaternion_json(link.joint.origin)},
                     {"parent", link.parent < 0 ? Json(nullptr) : Json(model.links[link.parent].name)},
                     {"line", link.line}});
  return links;
}

/// The links other than the root: first those with movable joints, by joint id, then the fixed ones.
std::vector<const Link*> links_by_joint(const Model& model) {
  std::vector<const Link*> links;
  for (const int link : model.joints) links.push_back(&model.links[link]);
  for (const Link& link : model.links)
    if (link.parent >= 0 && link.joint.id < 0) links.push_back(&link);
  return links;
}

/// A mesh file and the number of its uses in the model.
struct MeshUse {
  std::string file;  // as the model names it
  std::size_t triangles = 0;
  int visuals = 0;
  int collisions = 0;
};

/// The mesh files in the order of their first use.
std::vector<MeshUse> mesh_uses(const Model& model) {
  std::vector<MeshUse> uses;
  const auto count = [&uses](const std::vector<Shape>& shapes, int MeshUse::*number) {
    for (const Shape& shape : shapes) {
      const auto* mesh = std::get_if<Mesh>(&shape.geometry);
      if (mesh == nullptr) continue;
      const bool is_file = !mesh->file.empty();
      auto use = std::ranges::find_if(uses, [&](const MeshUse& other) { return is_file && other.file == mesh->file; });
      if (use == uses.end())
        use = uses.insert(uses.end(), {is_file ? mesh->file : "(in the model)", mesh->data->triangle_count()});
      ++((*use).*number);
    }
  };
  for (const Link& link : model.links) {
    count(link.visuals, &MeshUse::visuals);
    count(link.collisions, &MeshUse::collisions);
  }
  return uses;
}

/// Triangles of all visuals, or of all collisions.
std::size_t triangles_of(const std::vector<MeshUse>& meshes, int MeshUse::*number) {
  std::size_t triangles = 0;
  for (const MeshUse& mesh : meshes) triangles += mesh.triangles * static_cast<std::size_t>(mesh.*number);
  return triangles;
}

Json meshes_json(const std::vector<MeshUse>& meshes) {
  Json json = Json::array();
  for (const MeshUse& mesh : meshes)
    json.push_back({{"file", mesh.file}, {"uses", mesh.visuals + mesh.collisions}, {"triangles", mesh.triangles}});
  return json;
}

Json triangles_json(const std::vector<MeshUse>& meshes) {
  return {{"visuals", triangles_of(meshes, &MeshUse::visuals)},
          {"collisions", triangles_of(meshes, &MeshUse::collisions)}};
}

std::string mesh_text(const std::vector<MeshUse>& meshes, const char* kind, int MeshUse::*number) {
  int shapes = 0;
  for (const MeshUse& mesh : meshes) shapes += mesh.*number;
  return fmt::format("{} with {}", count_text(shapes, kind), count_text(triangles_of(meshes, number), "triangle"));
}

/// A sensor of a scenario has no line in the model's file.
const char* stated_in(const Device& device) { return device.line > 0 ? "model" : "scenario"; }

Json model_json(const Model& model) {
  const std::vector<MeshUse> meshes = mesh_uses(model);
  Json joints = Json::array();
  for (const Link* link : links_by_joint(model)) joints.push_back(joint_json(model, *link));
  Json devices = Json::array();
  for (const Device& device : model.devices)
    devices.push_back({{"name", device.name},
                       {"type", type_name(device)},
                       {"link", model.links[device.link].name},
                       {"id", device.id},
                       {"line", device.line},
                       {"stated_in", stated_in(device)}});
  return {{"name", model.name},   {"links", links_json(model)},       {"joints", joints},
          {"devices", devices},   {"meshes", meshes_json(meshes)},    {"triangles", triangles_json(meshes)},
          {"mass", model.mass()}, {"findings", json_of(model.report)}};
}

/// The same JSON members for a model that can't be loaded, so that readers need no special case.
Json json_without_model(const Diagnostics& errors) {
  return {{"name", nullptr},          {"links", Json::array()},     {"joints", Json::array()},
          {"devices", Json::array()}, {"meshes", Json::array()},    {"triangles", triangles_json({})},
          {"mass", nullptr},          {"findings", json_of(errors)}};
}

std::string joint_counts(const Model& model) {
  std::map<std::string_view, int> counts;
  for (const Link* link : links_by_joint(model)) ++counts[type_name(link->joint.type)];
  std::string text;
  for (const auto& [type, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, type);
  return text.empty() ? "" : " (" + text + ")";
}

std::string id_text(int id) { return id < 0 ? "-" : std::to_string(id); }

std::string type_text(const Model& model, const Joint& joint) {
  if (!joint.mimic) return std::string(type_name(joint.type));
  return fmt::format("{}, follows {}", type_name(joint.type), leader_name(model, *joint.mimic));
}

std::string range_text(const Joint& joint) {
  if (joint.lower == -unlimited && joint.upper == unlimited) return "any";
  return fmt::format("{:.4g} to {:.4g} {}", joint.lower, joint.upper, is_linear(joint.type) ? "m" : "rad");
}

std::string effort_text(const Joint& joint) {
  if (joint.effort == unlimited) return "any";
  return fmt::format("{:.4g} {}", joint.effort, is_linear(joint.type) ? "N" : "N·m");
}

bool has_rotor(const Link* link) { return link->joint.armature != 0.0; }

std::string rotor_text(const Joint& joint) {
  if (joint.armature == 0.0) return "-";
  const std::string whole = fmt::format("{:.4g} {}", joint.armature, is_linear(joint.type) ? "kg" : "kg·m²");
  if (joint.rotor_inertia == 0.0) return whole;
  return fmt::format("{:.4g} kg·m², gear {:.4g}: {}", joint.rotor_inertia, joint.gear_ratio, whole);
}

void tell(const Model& model, bool of_scenario = false) {
  const Joint& root = model.links[0].joint;
  fmt::print("{}: {}, {}{}, {}, {:.6g} kg, {}\n\n", model.name, count_text(model.links.size(), "link"),
             count_text(model.links.size() - 1, "joint"), joint_counts(model),
             count_text(model.devices.size(), "device"), model.mass(),
             root.type == JointType::free ? "free" : "fixed to the world");
  if (model.links.size() > 1) {
    const std::vector<const Link*> links = links_by_joint(model);
    const bool shows_rotors = std::ranges::any_of(links, has_rotor);
    std::vector<TableRow> rows{{"id", "joint", "type", "moves", "range", "effort"}};
    if (shows_rotors) rows[0].push_back("rotor");
    for (const Link* link : links) {
      rows.push_back({id_text(link->joint.controller_id.value_or(link->joint.id)), link->joint.name,
                      type_text(model, link->joint), link->name,
                      is_movable(link->joint.type) ? range_text(link->joint) : "-",
                      is_movable(link->joint.type) ? effort_text(link->joint) : "-"});
      if (shows_rotors) rows.back().push_back(is_movable(link->joint.type) ? rotor_text(link->joint) : "-");
    }
    print_table(rows);
    fmt::print("\n");
  }
  if (!model.devices.empty()) {
    std::vector<TableRow> rows{{"id", "device", "type", "link"}};
    if (of_scenario) rows[0].push_back("stated in");
    for (const Device& device : model.devices) {
      rows.push_back({id_text(device.id), device.name, std::string(type_name(device)), model.links[device.link].name});
      if (of_scenario) rows.back().push_back(stated_in(device));
    }
    print_table(rows);
    fmt::print("\n");
  }
  if (const std::vector<MeshUse> meshes = mesh_uses(model); !meshes.empty())
    fmt::print("{}: {}, {}\n\n", count_text(meshes.size(), "mesh file"), mesh_text(meshes, "visual", &MeshUse::visuals),
               mesh_text(meshes, "collision", &MeshUse::collisions));
  fmt::print("{}{}", model.report.empty() ? "nothing was repaired, ignored or doubted\n" : "", to_string(model.report));
}

/// The models of the bodies that have one in a file.
Exit inspect_scenario(const InspectSettings& settings) {
  const Result<Scenario> scenario = Scenario::load(settings.scenario);
  if (settings.json) {
    Json bodies = Json::array();
    if (scenario)
      for (const ScenarioBody& body : scenario->bodies)
        if (!body.model_file.empty()) bodies.push_back({{"body", body.name}, {"model", model_json(*body.model)}});
    print({{"bodies", bodies}, {"findings", json_of(scenario ? scenario->warnings : scenario.errors())}});
    return scenario ? Exit::done : Exit::bad_input;
  }
  if (!scenario) return refuse(scenario.errors());
  for (const ScenarioBody& body : scenario->bodies) {
    if (body.model_file.empty()) continue;
    fmt::print("body {}, of {}\n", body.name, body.model_file);
    tell(*body.model, true);
  }
  return Exit::done;
}

Exit run_inspect(const InspectSettings& settings) {
  if (!settings.scenario.empty()) return inspect_scenario(settings);
  const Result<Model> model = load_model(settings.model, settings.urdf);
  if (settings.json) {
    print(model ? model_json(*model) : json_without_model(model.errors()));
    return model ? Exit::done : Exit::bad_input;
  }
  if (!model) return refuse(model.errors());
  tell(*model);
  return Exit::done;
}

std::function<Exit()> declare_inspect(CLI::App& options) {
  const auto settings = std::make_shared<InspectSettings>();
  CLI::Option* model =
      options
          .add_option("MODEL", settings->model, "a URDF, a MuJoCo model, or a body of Choreonoid: .body, .yaml or .wrl")
          ->type_name("");
  options
      .add_option("--scenario", settings->scenario,
                  "in place of MODEL: the models of a scenario's bodies, with the sensors that it adds")
      ->type_name("SCENARIO")
      ->excludes(model);
  options.add_flag("--strict", settings->urdf.strict, "each repair is an error");
  add_model_options(options, settings->urdf);
  add_json_flag(options, settings->json);
  options.callback([settings] {
    if (settings->model.empty() && settings->scenario.empty()) throw CLI::RequiredError("MODEL");
  });
  return [settings] { return run_inspect(*settings); };
}

}  // namespace

extern const Verb inspect_verb{"inspect",
                               "  rehearse inspect fixtures/models/sr1.urdf\n"
                               "  rehearse inspect robot.urdf --strict --json\n"
                               "  rehearse inspect SR1.body\n"
                               "  rehearse inspect --scenario fixtures/scenarios/rover.yaml\n"
                               "  rehearse inspect arm.urdf --package arm_description=../arm_description\n",
                               declare_inspect};

}  // namespace rehearse::tool
