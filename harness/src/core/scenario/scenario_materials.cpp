// Materials of links, and the friction and restitution of pairs of them.
#include "base/names.h"
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse {
namespace {

const BoundForm<MaterialPair>& bound_pair_form() {
  static const BoundForm<MaterialPair> form{
      "pair",
      "a pair",
      {FormKey{"between", types::list(types::text(), 2, 2), "two materials", required},
       {"friction", &MaterialPair::friction, any_friction, "coefficient between them"},
       {"restitution", &MaterialPair::restitution, any_restitution, "of impacts between them"}},
      {{"friction", "restitution"}}};
  return form;
}

/// Gives the material to the links that "Body" or "Body/Link" names.
void set_material(Findings& findings, const NamedEntry& entry, const std::string& material, Scenario& scenario) {
  const std::size_t slash = std::min(entry.name.find('/'), entry.name.size());
  const auto index = find_body(findings, *entry.key, std::string_view(entry.name).substr(0, slash), scenario);
  if (!index) return;
  ScenarioBody& body = scenario.bodies[static_cast<std::size_t>(*index)];
  if (body.model == nullptr) return;
  body.materials.resize(body.model->links.size());
  if (slash == entry.name.size()) {
    for (std::string& of_link : body.materials)
      if (of_link.empty()) of_link = material;
    return;
  }
  const std::string name = entry.name.substr(slash + 1);
  if (const auto link = find_link(findings, *entry.key, name, body))
    body.materials[static_cast<std::size_t>(*link)] = material;
}

void add_once(const std::string& name, std::vector<std::string>& names) {
  if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
}

/// The names of all materials that the models state, each once.
std::vector<std::string> materials_of_models(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const ScenarioBody& body : scenario.bodies)
    for (const std::string& name : body.materials) add_once(name, names);
  return names;
}

/// Adds the names of all materials in document order.
void read_materials(Findings& findings, const YamlNode& node, std::vector<std::string>& names, Scenario& scenario) {
  if (node.kind != YamlNode::Kind::map) {
    expected(findings, node, "materials", "a map of BODY: MATERIAL or BODY/LINK: MATERIAL");
    return;
  }
  std::vector<std::pair<NamedEntry, std::string>> of_bodies;  // set last: a link with its own entry keeps it
  for (const NamedEntry& entry : read_entries(findings, node)) {
    const auto material = read_name(findings, *entry.value, "a material");
    if (!material) continue;
    add_once(*material, names);
    if (entry.name.find('/') == std::string::npos)
      of_bodies.emplace_back(entry, *material);
    else
      set_material(findings, entry, *material, scenario);
  }
  for (const auto& [entry, material] : of_bodies) set_material(findings, entry, material, scenario);
}

/// The two materials of a pair; nothing if there is a mistake.
std::optional<std::array<std::string, 2>> read_between(Findings& findings, const YamlNode& node,
                                                       const std::vector<std::string>& known) {
  constexpr const char* two_names = "a list of two materials, [A, B]";
  if (node.kind != YamlNode::Kind::list || node.items.size() != 2) {
    expected(findings, node, "between", two_names);
    return std::nullopt;
  }
  std::array<std::string, 2> materials;
  bool is_right = true;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto name = read_text(findings, *node.items[i], "a material", two_names);
    materials[i] = name.value_or("");
    const bool is_known = std::ranges::find(known, materials[i]) != known.end();
    if (name && !is_known)
      findings.error(*node.items[i], fmt::format("no link has the material '{}'", shortened(*name)),
                     name_hint(*name, known, "materials"));
    is_right &= name && is_known;
  }
  if (!is_right) return std::nullopt;
  std::ranges::sort(materials);
  return materials;
}

void read_pair(Findings& findings, const YamlNode& node, const std::vector<std::string>& known, Scenario& scenario) {
  const Keys keys(findings, node, pair_form());
  if (!keys.is_map()) return;
  MaterialPair pair;
  bound_pair_form().read(keys, pair);
  if (keys.find("friction") == nullptr && keys.find("restitution") == nullptr)
    findings.error(node, "a pair has neither 'friction' nor 'restitution'", "expected at least one of them");
  const YamlNode* between = keys.require("between", "two materials, [A, B]");
  const auto materials = between == nullptr ? std::nullopt : read_between(findings, *between, known);
  if (!materials) return;
  pair.materials = *materials;
  const auto is_same = [&pair](const MaterialPair& other) { return other.materials == pair.materials; };
  if (std::ranges::any_of(scenario.pairs, is_same))
    findings.error(
        *between,
        fmt::format("a second pair of '{}' and '{}'", shortened(pair.materials[0]), shortened(pair.materials[1])),
        "expected one pair for two materials");
  scenario.pairs.push_back(std::move(pair));
}

}  // namespace

const Form& pair_form() { return bound_pair_form(); }

void read_materials(Findings& findings, const YamlNode* materials, const YamlNode* pairs, Scenario& scenario) {
  std::vector<std::string> known = materials_of_models(scenario);
  if (materials != nullptr) read_materials(findings, *materials, known, scenario);
  const bool has_all_models =
      std::ranges::all_of(scenario.bodies, [](const ScenarioBody& body) { return body.model != nullptr; });
  if (pairs == nullptr || !has_all_models) return;  // materials of a model that can't be used are unknown
  for (const YamlNodePtr& pair : read_list(findings, *pairs, "pairs", "a list of pairs of materials"))
    read_pair(findings, *pair, known, scenario);
}

}  // namespace rehearse
