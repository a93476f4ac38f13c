// Materials of links, and the friction and restitution of pairs of them.
#include "model/names.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse {
namespace {

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
  const int link = body.model->find_link(name);
  if (link >= 0) {
    body.materials[static_cast<std::size_t>(link)] = material;
    return;
  }
  std::vector<std::string> names;
  for (const Link& known : body.model->links) names.push_back(known.name);
  findings.error(*entry.key, fmt::format("{} has no link '{}'", body.name, shortened(name)),
                 name_hint(name, names, "links"));
}

/// The names of all materials, in document order, each once.
std::vector<std::string> read_materials(Findings& findings, const YamlNode& node, Scenario& scenario) {
  std::vector<std::string> names;
  if (node.kind != YamlNode::Kind::map) {
    expected(findings, node, "materials", "a map of BODY: MATERIAL or BODY/LINK: MATERIAL");
    return names;
  }
  std::vector<std::pair<NamedEntry, std::string>> of_bodies;  // after those of links, which go before them
  for (const NamedEntry& entry : read_entries(findings, node)) {
    const auto material = read_name(findings, *entry.value, "a material");
    if (!material) continue;
    if (std::find(names.begin(), names.end(), *material) == names.end()) names.push_back(*material);
    if (entry.name.find('/') == std::string::npos)
      of_bodies.emplace_back(entry, *material);
    else
      set_material(findings, entry, *material, scenario);
  }
  for (const auto& [entry, material] : of_bodies) set_material(findings, entry, material, scenario);
  return names;
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
    const bool is_known = std::find(known.begin(), known.end(), materials[i]) != known.end();
    if (name && !is_known)
      findings.error(*node.items[i], fmt::format("nothing is of the material '{}'", shortened(*name)),
                     name_hint(*name, known, "materials"));
    is_right &= name && is_known;
  }
  if (!is_right) return std::nullopt;
  std::sort(materials.begin(), materials.end());
  return materials;
}

void read_pair(Findings& findings, const YamlNode& node, const std::vector<std::string>& known, Scenario& scenario) {
  const Keys keys(findings, node, "a pair", {"between", "friction", "restitution"});
  if (!keys.is_map()) return;
  MaterialPair pair;
  keys.number("friction", {0.0, 1e6}, pair.friction);
  keys.number("restitution", {0.0, 1.0}, pair.restitution);
  if (keys.find("friction") == nullptr && keys.find("restitution") == nullptr)
    findings.error(node, "a pair has neither 'friction' nor 'restitution'", "expected at least one of them");
  const YamlNode* between = keys.require("between", "two materials, [A, B]");
  const auto materials = between == nullptr ? std::nullopt : read_between(findings, *between, known);
  if (!materials) return;
  pair.materials = *materials;
  const auto is_same = [&pair](const MaterialPair& other) { return other.materials == pair.materials; };
  if (std::any_of(scenario.pairs.begin(), scenario.pairs.end(), is_same))
    findings.error(
        *between,
        fmt::format("a second pair of '{}' and '{}'", shortened(pair.materials[0]), shortened(pair.materials[1])),
        "expected one for two materials");
  scenario.pairs.push_back(std::move(pair));
}

}  // namespace

void read_materials(Findings& findings, const YamlNode* materials, const YamlNode* pairs, Scenario& scenario) {
  std::vector<std::string> known;
  if (materials != nullptr) known = read_materials(findings, *materials, scenario);
  if (pairs == nullptr) return;
  const auto* list = read_list(findings, *pairs, "pairs", "a list of pairs of materials");
  if (list == nullptr) return;
  for (const YamlNodePtr& pair : *list) read_pair(findings, *pair, known, scenario);
}

}  // namespace rehearse
