// rehearse inspect: loads a robot model and reports what was understood of it.
#include <fmt/format.h>
#include <rehearse/urdf.h>

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

struct Settings {
  std::string model;
  bool json = false;
  UrdfOptions urdf;
};

Json limit_json(double limit) { return std::abs(limit) == unlimited ? Json(nullptr) : json_of(limit); }

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
          {"mimic", mimic_json(model, joint)},
          {"line", joint.line}};
}

/// A link's type is that of what joins it to its parent, the root's that of what joins it to the world.
Json links_json(const Model& model) {
  Json links = Json::array();
  for (const Link& link : model.links)
    links.push_back({{"name", link.name},
                     {"type", type_name(link.joint.type)},
                     {"mass", link.inertial.mass},
                     {"parent", link.parent < 0 ? Json(nullptr) : Json(model.links[link.parent].name)},
                     {"line", link.line}});
  return links;
}

/// The links other than the root, those whose joints move by id first, then the fixed ones.
std::vector<const Link*> links_by_joint(const Model& model) {
  std::vector<const Link*> links;
  for (const int link : model.joints) links.push_back(&model.links[link]);
  for (const Link& link : model.links)
    if (link.parent >= 0 && link.joint.id < 0) links.push_back(&link);
  return links;
}

Json model_json(const Model& model) {
  Json joints = Json::array();
  for (const Link* link : links_by_joint(model)) joints.push_back(joint_json(model, *link));
  Json devices = Json::array();
  for (const Device& device : model.devices)
    devices.push_back({{"name", device.name},
                       {"type", type_name(device)},
                       {"link", model.links[device.link].name},
                       {"id", device.id},
                       {"line", device.line}});
  return {{"name", model.name}, {"links", links_json(model)}, {"joints", joints},
          {"devices", devices}, {"mass", model.mass()},       {"findings", json_of(model.report)}};
}

/// The same shape when there is no model: readers need not ask twice.
Json json_without_model(const Diagnostics& errors) {
  return {{"name", nullptr},          {"links", Json::array()}, {"joints", Json::array()},
          {"devices", Json::array()}, {"mass", nullptr},        {"findings", json_of(errors)}};
}

std::string joint_counts(const Model& model) {
  std::map<std::string_view, int> counts;
  for (const Link* link : links_by_joint(model)) ++counts[type_name(link->joint.type)];
  std::string text;
  for (const auto& [type, count] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, type);
  return text.empty() ? "" : " (" + text + ")";
}

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

void tell(const Model& model) {
  const Joint& root = model.links[0].joint;
  fmt::print("{}: {}, {}{}, {}, {:.6g} kg, {}\n\n", model.name,
             count_text(static_cast<int>(model.links.size()), "link"),
             count_text(static_cast<int>(model.links.size()) - 1, "joint"), joint_counts(model),
             count_text(static_cast<int>(model.devices.size()), "device"), model.mass(),
             root.type == JointType::free ? "free" : "fixed to the world");
  if (model.links.size() > 1) {
    std::vector<TableRow> rows{{"id", "joint", "type", "moves", "range", "effort"}};
    for (const Link* link : links_by_joint(model))
      rows.push_back({link->joint.id < 0 ? "-" : std::to_string(link->joint.id), link->joint.name,
                      type_text(model, link->joint), link->name,
                      is_movable(link->joint.type) ? range_text(link->joint) : "-",
                      is_movable(link->joint.type) ? effort_text(link->joint) : "-"});
    print_table(rows);
    fmt::print("\n");
  }
  if (!model.devices.empty()) {
    std::vector<TableRow> rows{{"id", "device", "type", "link"}};
    for (const Device& device : model.devices)
      rows.push_back({device.id < 0 ? "-" : std::to_string(device.id), device.name, std::string(type_name(device)),
                      model.links[device.link].name});
    print_table(rows);
    fmt::print("\n");
  }
  fmt::print("{}{}", model.report.empty() ? "nothing was repaired, ignored or doubted\n" : "", to_string(model.report));
}

Exit run(const Settings& settings) {
  const Result<Model> model = load_urdf(settings.model, settings.urdf);
  if (settings.json) {
    print(model ? model_json(*model) : json_without_model(model.errors()));
    return model ? Exit::done : Exit::bad_input;
  }
  if (!model) return refuse(model.errors());
  tell(*model);
  return Exit::done;
}

std::function<Exit()> declare(CLI::App& options) {
  const auto settings = std::make_shared<Settings>();
  options.add_option("MODEL", settings->model, "a URDF file")->required()->type_name("");
  options.add_flag("--strict", settings->urdf.strict, "what would be repaired is an error");
  add_json_flag(options, settings->json);
  return [settings] { return run(*settings); };
}

}  // namespace

const Verb inspect_verb{"inspect",
                        "  rehearse inspect fixtures/models/sr1.urdf\n"
                        "  rehearse inspect robot.urdf --strict --json\n",
                        declare};

}  // namespace rehearse::tool
