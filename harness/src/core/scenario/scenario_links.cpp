#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace rehearse {
namespace {

const BoundForm<Surface>& bound_link_form() {
  static const BoundForm<Surface> form{
      "link",
      "a link",
      {FormKey{"mass", types::number(any_mass), "[kg]; its inertia changes in proportion"},
       {"friction", &Surface::friction, any_friction, "coefficient in all directions"},
       {"restitution", &Surface::restitution, any_restitution, "of impacts"}}};
  return form;
}

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

/// The keys of a link, with the defaults of those that aren't stated.
Keys link_keys(Findings& findings, const YamlNode& node, const SolverSettings& solver, const Link* link) {
  Keys keys(findings, node, link_form());
  if (!link) return keys;
  if (link->inertial.mass > 0.0) keys.set_default("mass", {fmt::format("{}", link->inertial.mass)});
  state_surface(keys, solver, link->surface);
  return keys;
}

}  // namespace

const Form& link_form() { return bound_link_form(); }

void state_surface(const Keys& keys, const SolverSettings& solver, const Surface& known) {
  keys.set_default("friction", {fmt::format("{}", known.friction.value_or(solver.friction))});
  keys.set_default("restitution", {fmt::format("{}", known.restitution.value_or(0.0))});
}

void state_links(Findings& findings, const YamlNode& links, const SolverSettings& solver, const Model& model) {
  for (const Link& link : model.links)
    if (find_key(links, link.name) == nullptr)
      link_keys(findings, findings.absent_map(links, link.name), solver, &link);
}

void read_links(Findings& findings, const YamlNode& node, const SolverSettings& solver, ScenarioBody& body) {
  if (node.kind != YamlNode::Kind::map) return expected(findings, node, "links", "a map of LINK: {mass: ..., ...}");
  auto model = std::make_shared<Model>(*body.model);  // other bodies keep the model of the file
  for (const NamedEntry& entry : read_entries(findings, node)) {
    const auto index = find_link(findings, *entry.key, entry.name, body);
    Link* const link = index ? &model->links[static_cast<std::size_t>(*index)] : nullptr;
    const Keys keys = link_keys(findings, *entry.value, solver, link);
    if (!link || !keys.is_map()) continue;
    if (const YamlNode* mass = keys.find("mass")) read_mass(findings, *mass, *link);
    bound_link_form().read(keys, link->surface);
    if (keys.find("friction")) link->surface.second_friction.reset();  // in all directions
  }
  body.model = std::move(model);
}

}  // namespace rehearse
