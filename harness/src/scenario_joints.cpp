#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

namespace rehearse {
namespace {

const Joint& joint_of(const Model& model, std::size_t id) {
  return model.links[static_cast<std::size_t>(model.joints[id])].joint;
}

std::vector<std::string> joint_names(const Model& model) {
  std::vector<std::string> names;
  for (std::size_t id = 0; id < model.joints.size(); ++id) names.push_back(joint_of(model, id).name);
  return names;
}

std::optional<double> read_displacement(Findings& findings, const YamlNode& node, const Joint& joint) {
  if (joint.type == JointType::prismatic) return read_number(findings, node, joint.name, any_position);
  return read_angle(findings, node, joint.name);
}

void read_by_name(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  const Model& model = *body.model;
  for (const NamedEntry& entry : read_entries(findings, node)) {
    const int link = model.find_joint(entry.name);
    if (link < 0) {
      findings.error(*entry.key, fmt::format("{} has no joint '{}'", body.name, entry.name),
                     name_hint(entry.name, joint_names(model), "joints"));
      continue;
    }
    const Joint& joint = model.links[static_cast<std::size_t>(link)].joint;
    if (joint.name != entry.name) {  // find_joint also takes the name of the link that a joint moves
      findings.error(*entry.key, fmt::format("'{}' is a link of {}", entry.name, body.name),
                     joint.name.empty() ? "expected a joint" : fmt::format("its joint is '{}'", joint.name));
    } else if (joint.id < 0) {
      findings.error(*entry.key, fmt::format("joint '{}' of {} is fixed", entry.name, body.name),
                     "only movable joints have a displacement");
    } else if (const auto value = read_displacement(findings, *entry.value, joint)) {
      body.joints[static_cast<std::size_t>(joint.id)] = *value;
    }
  }
}

void read_by_id(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  const Model& model = *body.model;
  if (node.items.size() != model.joints.size()) {
    findings.error(node,
                   fmt::format("joints lists {} displacements, but {} has {} joints", node.items.size(), body.name,
                               model.joints.size()),
                   "expected all of them by joint id, or a map of NAME: DISPLACEMENT");
    return;
  }
  for (std::size_t id = 0; id < node.items.size(); ++id) {
    if (const auto value = read_displacement(findings, *node.items[id], joint_of(model, id))) body.joints[id] = *value;
  }
}

}  // namespace

void read_joints(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  if (node.kind == YamlNode::Kind::map) {
    read_by_name(findings, node, body);
  } else if (node.kind == YamlNode::Kind::list) {
    read_by_id(findings, node, body);
  } else {
    expected(findings, node, "joints", "a map of NAME: DISPLACEMENT, or a list of all displacements by joint id");
  }
}

}  // namespace rehearse
