// Writes the nodes of a YAML tree.
#pragma once

#include <fmt/format.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "yaml/yaml_tree.h"

namespace rehearse::body {

inline YamlNodePtr text_node(std::string_view text, int line) {
  auto node = std::make_shared<YamlNode>();
  node->kind = YamlNode::Kind::scalar;
  node->text = text;
  node->line = line;
  return node;
}

/// The number with all its bits.
inline YamlNodePtr number_node(double number, int line) { return text_node(fmt::format("{}", number), line); }

inline YamlNodePtr list_node(std::vector<YamlNodePtr> items, int line) {
  auto node = std::make_shared<YamlNode>();
  node->kind = YamlNode::Kind::list;
  node->items = std::move(items);
  node->line = line;
  return node;
}

inline YamlNodePtr numbers_node(const std::vector<double>& numbers, int line) {
  std::vector<YamlNodePtr> items;
  for (const double number : numbers) items.push_back(number_node(number, line));
  return list_node(std::move(items), line);
}

/// Writes a mapping, key by key.
class MapWriter {
 public:
  explicit MapWriter(int line) : node_(std::make_shared<YamlNode>()) {
    node_->kind = YamlNode::Kind::map;
    node_->line = line;
  }
  void add(std::string_view key, YamlNodePtr value) {
    node_->keys.push_back(text_node(key, value->line));
    node_->items.push_back(std::move(value));
  }
  YamlNodePtr node() const { return node_; }

 private:
  std::shared_ptr<YamlNode> node_;
};

}  // namespace rehearse::body
