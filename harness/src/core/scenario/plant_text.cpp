#include "plant_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "scenario_values.h"
#include "yaml/yaml_tree.h"

namespace rehearse {
namespace {

/// Keys of the scenario that have no effect on its world. All other keys count, also those of later versions.
constexpr std::string_view judging[] = {"name",    "golden", "tolerances", "horizon",   "expect",    "simulate",
                                        "options", "vary",   "realtime",   "pass_rate", "sometimes", "plan"};
/// Keys of a controller. Its name and its place in the list count: controllers are called in this order.
constexpr std::string_view of_controller[] = {"library", "options", "delay", "optional"};

template <std::size_t count>
bool is_one_of(std::string_view word, const std::string_view (&words)[count]) {
  return std::ranges::find(words, word) != std::end(words);
}

enum class Inside { scenario, bodies, body, controllers, controller, other };

bool is_left_out(Inside inside, std::string_view key) {
  return (inside == Inside::scenario && is_one_of(key, judging)) ||
         (inside == Inside::controller && is_one_of(key, of_controller));
}

Inside below(Inside inside, std::string_view key) {
  if (inside == Inside::scenario && key == "bodies") return Inside::bodies;
  if (inside == Inside::body && key == "controllers") return Inside::controllers;
  if (inside == Inside::controller && key == "children") return Inside::controllers;
  return Inside::other;
}

Inside item_of(Inside list) {
  if (list == Inside::bodies) return Inside::body;
  return list == Inside::controllers ? Inside::controller : Inside::other;
}

void write_node(const YamlNode& node, Inside inside, int depth, std::string& text) {
  const std::string indent(static_cast<std::size_t>(depth), ' ');
  switch (node.kind) {
    case YamlNode::Kind::empty: text += indent + "~\n"; return;
    case YamlNode::Kind::scalar:
      text += fmt::format("{}{}{} {}\n", indent, node.quoted ? '"' : ':', node.text.size(), node.text);
      return;
    case YamlNode::Kind::list:
      text += fmt::format("{}[{}\n", indent, node.items.size());
      for (const YamlNodePtr& item : node.items) write_node(*item, item_of(inside), depth + 1, text);
      return;
    case YamlNode::Kind::map:
      text += indent + "{\n";
      for (std::size_t i = 0; i < node.keys.size(); ++i) {
        const std::string& key = node.keys[i]->text;
        if (is_left_out(inside, key)) continue;
        write_node(*node.keys[i], Inside::other, depth + 1, text);
        write_node(*node.items[i], below(inside, key), depth + 2, text);
      }
      text += indent + "}\n";
      return;
  }
}

}  // namespace

bool only_judges(std::string_view key) { return key != "options" && is_one_of(key, judging); }

Result<std::string> plant_text(const Scenario& scenario) {
  const YamlNodePtr root = REHEARSE_TRY(parse_yaml(scenario.text, scenario.file));
  std::string text;
  write_node(*root, Inside::scenario, 0, text);
  return text;
}

bool has_mesh_files(const Scenario& scenario) {
  const auto is_mesh_file = [](const Shape& shape) {
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    return mesh != nullptr && !mesh->heightmap && !mesh->file.empty();
  };
  return std::ranges::any_of(scenario.bodies, [&](const ScenarioBody& body) {
    return std::ranges::any_of(body.model->links, [&](const Link& link) {
      return std::ranges::any_of(link.visuals, is_mesh_file) || std::ranges::any_of(link.collisions, is_mesh_file);
    });
  });
}

bool always_simulates(const Scenario& scenario) {
  // most texts have no such word, and no escape that may stand for its letters
  if (scenario.text.find("simulate") == std::string::npos && scenario.text.find('\\') == std::string::npos)
    return false;
  const Result<YamlNodePtr> root = parse_yaml(scenario.text, scenario.file);
  const YamlNode* node = root ? find_key(**root, "simulate") : nullptr;
  return node && node->text == "always";
}

}  // namespace rehearse
