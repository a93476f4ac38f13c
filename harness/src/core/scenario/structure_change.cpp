#include "structure_change.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "scenario_parts.h"
#include "scenario_values.h"
#include "yaml/yaml_tree.h"

namespace rehearse {
namespace {

/// A body or a controller in the text, or a part of a model.
struct Named {
  std::string name;
  const YamlNode* node = nullptr;  // the map of its keys
  int line = 0;                    // of its name; 0: it is of a model
};

std::vector<Named> named_items(const YamlNode& of, const char* key) {
  std::vector<Named> items;
  const YamlNode* list = find_key(of, key);
  if (!list || list->kind != YamlNode::Kind::list) return items;
  for (const YamlNodePtr& item : list->items) {
    if (item->kind != YamlNode::Kind::map) continue;
    const YamlNode *name = find_key(*item, "name"), *library = find_key(*item, "library");
    if (name)
      items.push_back({name->text, item.get(), name->line});
    else if (library)  // a controller has the name of its library
      items.push_back({name_of_library(library->text), item.get(), library->line});
  }
  return items;
}

const Named* find(const std::vector<Named>& items, const std::string& name) {
  const auto found = std::ranges::find(items, name, &Named::name);
  return found == items.end() ? nullptr : &*found;
}

/// The first item that only one of the lists has. An item that has taken the place of another one is renamed.
std::string change_of_names(const std::vector<Named>& before, const std::vector<Named>& now, const std::string& what) {
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (find(before, now[i].name)) continue;
    const std::string line = now[i].line > 0 ? fmt::format("line {}: ", now[i].line) : "";
    const bool renamed = before.size() == now.size() && !find(now, before[i].name);
    return renamed ? fmt::format("{}{} '{}' was named '{}'", line, what, now[i].name, before[i].name)
                   : fmt::format("{}{} '{}' is new", line, what, now[i].name);
  }
  for (const Named& item : before)
    if (!find(now, item.name)) return fmt::format("{} '{}' is gone", what, item.name);
  return "";
}

/// The change of a flag of a controller.
std::string change_of_flag(const Named& before, const Named& now, const char* key, const char* usual,
                           const std::string& label) {
  const YamlNode *then = find_key(*before.node, key), *here = find_key(*now.node, key);
  const std::string was = then ? then->text : usual, is = here ? here->text : usual;
  if (was == is) return "";
  return fmt::format("line {}: {} of controller '{}' is {}, and was {}", here ? here->line : now.line, key, label, is,
                     was);
}

std::string change_of_controllers(const YamlNode& before, const YamlNode& now, const char* key,
                                  const std::string& body) {
  const std::vector<Named> then = named_items(before, key), here = named_items(now, key);
  if (std::string change = change_of_names(then, here, fmt::format("controller of body '{}':", body)); !change.empty())
    return change;
  for (const Named& controller : here) {
    const Named& earlier = *find(then, controller.name);
    const std::string label = body + "/" + controller.name;
    for (const auto& [flag, usual] : {std::pair("delay", "true"), std::pair("optional", "false")})
      if (std::string change = change_of_flag(earlier, controller, flag, usual, label); !change.empty()) return change;
    if (std::string change = change_of_controllers(*earlier.node, *controller.node, "children", body); !change.empty())
      return change;
  }
  return "";
}

}  // namespace

std::string structure_change(const std::string& before, const std::string& now) {
  const Result<YamlNodePtr> then = parse_yaml(before, ""), here = parse_yaml(now, "");
  if (!then || !here) return "";
  const std::vector<Named> bodies_then = named_items(**then, "bodies"), bodies = named_items(**here, "bodies");
  if (std::string change = change_of_names(bodies_then, bodies, "body"); !change.empty()) return change;
  for (const Named& body : bodies) {
    std::string change =
        change_of_controllers(*find(bodies_then, body.name)->node, *body.node, "controllers", body.name);
    if (!change.empty()) return change;
  }
  return "";
}

std::string model_change(const Scenario& before, const Scenario& now) {
  const auto joints_of = [](const Model& model) {
    std::vector<Named> joints;
    for (const int link : model.joints) joints.push_back({model.links[static_cast<std::size_t>(link)].joint.name});
    return joints;
  };
  const auto parts_of = [](const auto& parts) {
    std::vector<Named> all;
    for (const auto& part : parts) all.push_back({part.name});
    return all;
  };
  for (const ScenarioBody& body : now.bodies) {
    const auto earlier = std::ranges::find(before.bodies, body.name, &ScenarioBody::name);
    if (earlier == before.bodies.end()) continue;
    const Model &then = *earlier->model, &here = *body.model;
    for (const std::string& change : {change_of_names(joints_of(then), joints_of(here), "joint"),
                                      change_of_names(parts_of(then.links), parts_of(here.links), "link"),
                                      change_of_names(parts_of(then.devices), parts_of(here.devices), "device")})
      if (!change.empty()) return fmt::format("the model of '{}' changed: {}", body.name, change);
  }
  return "";
}

}  // namespace rehearse
