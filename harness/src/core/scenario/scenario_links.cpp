#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace rehearse {
namespace {

/// The inertia is that of the same shape with another density.
void read_mass(Findings& findings, const YamlNode& node, Link& link) {
  const auto mass = read_number(findings, node, "mass", any_mass);
  if (!mass) return;
  if (link.inertial.mass <= 0.0)
    return findings.error(node, fmt::format("mass is given for the link '{}', which has no mass", link.name),
                          "its inertia is unknown; the model's file may state both");
  link.inertial.inertia *= *mass / link.inertial.mass;
  link.inertial.mass = *mass;
}

}  // namespace

void read_links(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  if (node.kind != YamlNode::Kind::map) return expected(findings, node, "links", "a map of LINK: {mass: ..., ...}");
  auto model = std::make_shared<Model>(*body.model);  // other bodies keep the model of the file
  for (const NamedEntry& entry : read_entries(findings, node)) {
    const auto index = find_link(findings, *entry.key, entry.name, body);
    const Keys keys(findings, *entry.value, "a link", {"mass", "friction", "restitution"});
    if (!index || !keys.is_map()) continue;
    Link& link = model->links[static_cast<std::size_t>(*index)];
    if (const YamlNode* mass = keys.find("mass")) read_mass(findings, *mass, link);
    keys.number("friction", any_friction, link.surface.friction);
    keys.number("restitution", any_restitution, link.surface.restitution);
    if (keys.find("friction")) link.surface.second_friction.reset();  // in all directions
  }
  body.model = std::move(model);
}

}  // namespace rehearse
