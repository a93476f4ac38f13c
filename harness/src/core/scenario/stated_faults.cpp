#include "stated_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "scenario_parts.h"
#include "yaml/yaml_tree.h"

namespace rehearse {
namespace {

StatedFault read_stated(const YamlNode& node, const std::string& body, std::size_t of_body, std::size_t index) {
  StatedFault stated;
  stated.body = body;
  for (const std::string_view owner : fault_owners)
    if (const YamlNode* part = find_key(node, owner)) {
      stated.owner = owner;
      stated.part = part->text;
    }
  if (const YamlNode* fault = find_key(node, "fault")) stated.fault = fault->text;
  stated.paths = {fmt::format("bodies.{}.faults[{}].", body, index),
                  fmt::format("bodies[{}].faults[{}].", of_body, index)};
  return stated;
}

}  // namespace

bool StatedFault::contains(std::string_view path) const {
  return std::ranges::any_of(paths, [&](const std::string& begin) { return path.starts_with(begin); });
}

std::vector<StatedFault> stated_faults(const Scenario& scenario) {
  std::vector<StatedFault> stated;
  const Result<YamlNodePtr> root = parse_yaml(scenario.text, scenario.file);
  const YamlNode* bodies = root ? find_key(**root, "bodies") : nullptr;
  if (!bodies) return stated;
  for (std::size_t b = 0; b < std::min(bodies->items.size(), scenario.bodies.size()); ++b) {
    const YamlNode* faults = find_key(*bodies->items[b], "faults");
    for (std::size_t i = 0; faults && i < faults->items.size(); ++i)
      stated.push_back(read_stated(*faults->items[i], scenario.bodies[b].name, b, i));
  }
  return stated;
}

}  // namespace rehearse
