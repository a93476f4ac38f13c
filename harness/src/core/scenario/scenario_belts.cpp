// The `belts` of a body: links whose surface runs, although the model's file connects them by fixed joints.
#include <rehearse/scenario.h>

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

namespace rehearse {
namespace {

/// Makes the fixed joint of a link a track about `axis`, a direction in the link's frame.
void add_track(Model& model, int link, const Eigen::Vector3d& axis) {
  Joint& joint = model.links[static_cast<std::size_t>(link)].joint;
  joint.type = JointType::track;
  joint.axis = axis.stableNormalized();
  joint.id = static_cast<int>(model.joints.size());
  joint.controller_id = -1;
  model.joints.push_back(link);
}

void read_belt(Findings& findings, const YamlNode& node, const ScenarioBody& body, Model& model) {
  const Keys keys(findings, node, belt_form());
  if (!keys.is_map()) return;
  const YamlNode* link_node = keys.require("link", "the link whose surface runs");
  const auto name = link_node ? read_text(findings, *link_node, "link", "the name of a link") : std::nullopt;
  const auto link = name ? find_link(findings, *link_node, *name, body) : std::nullopt;
  const YamlNode* axis_node =
      keys.require("axis", "the axis of the belt's wheels in the link's frame, as in [0, 1, 0]");
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  if (axis_node) keys.read("axis", axis);
  if (!link || !axis_node) return;
  if (axis.isZero(0.0))
    return findings.error(*axis_node, "the axis of a belt is zero", "a direction in the link's frame, as in [0, 1, 0]");
  const Joint& joint = model.links[static_cast<std::size_t>(*link)].joint;
  if (joint.type == JointType::track)
    return findings.error(*link_node, fmt::format("link '{}' is a belt already", *name),
                          body.model->links[static_cast<std::size_t>(*link)].joint.type == JointType::track
                              ? "the model's file makes it one"
                              : "it is in the list above");
  if (*link == 0 || joint.type != JointType::fixed)
    return findings.error(*link_node,
                          fmt::format("link '{}' can't be a belt: {}", *name,
                                      *link == 0 ? "it is the root" : "it moves against its parent"),
                          "expected a link that a fixed joint connects to its parent");
  add_track(model, *link, axis);
}

}  // namespace

void read_belts(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  Model model = *body.model;  // other bodies keep the model of the file
  for (const YamlNodePtr& belt : read_list(findings, node, "belts", "a list of {link: L, axis: [X, Y, Z]}"))
    read_belt(findings, *belt, body, model);
  body.model = std::make_shared<const Model>(std::move(model));
}

}  // namespace rehearse
