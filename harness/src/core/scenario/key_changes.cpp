#include "key_changes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "base/text.h"
#include "plant_text.h"
#include "yaml/yaml_tree.h"

namespace rehearse {
namespace {

/// A key with a value, or with keys below it.
struct Key {
  std::string name;
  std::optional<std::string> value;  // of a scalar, or of a list of scalars
  int line = 0;
  std::vector<Key> keys = {};
};

/// Gives siblings with equal names a number: the second "visual" is "visual 2".
void number_equal_names(std::vector<Key>& keys) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    int count = 1;
    for (std::size_t k = i + 1; k < keys.size(); ++k)
      if (keys[k].name == keys[i].name) keys[k].name += fmt::format(" {}", ++count);
  }
}

Key key_of(const YamlNode& node, std::string name, int line);

/// The name of a list's item: the value of a key that identifies it, or its number, from 1 on.
std::string name_of_item(const YamlNode& item, std::size_t index) {
  constexpr std::array<std::string_view, 4> identifying{"name", "library", "link", "channel"};
  for (std::size_t i = 0; i < item.keys.size(); ++i)
    if (std::ranges::find(identifying, item.keys[i]->text) != identifying.end()) return item.items[i]->text;
  return fmt::format("{}", index + 1);
}

std::optional<std::string> value_of(const YamlNode& node) {
  if (node.kind == YamlNode::Kind::scalar) return node.text;
  const auto is_scalar = [](const YamlNodePtr& item) { return item->kind == YamlNode::Kind::scalar; };
  if (node.kind != YamlNode::Kind::list || !std::ranges::all_of(node.items, is_scalar)) return std::nullopt;
  std::vector<std::string_view> items;
  for (const YamlNodePtr& item : node.items) items.push_back(item->text);
  return fmt::format("[{}]", fmt::join(items, ", "));
}

Key key_of(const YamlNode& node, std::string name, int line) {
  Key key{std::move(name), value_of(node), line};
  if (key.value) return key;
  const bool is_map = node.kind == YamlNode::Kind::map;
  for (std::size_t i = 0; i < node.items.size(); ++i)
    key.keys.push_back(is_map ? key_of(*node.items[i], node.keys[i]->text, node.keys[i]->line)
                              : key_of(*node.items[i], name_of_item(*node.items[i], i), node.items[i]->line));
  number_equal_names(key.keys);
  return key;
}

Key key_of(const tinyxml2::XMLElement& element) {
  const char* name = element.Attribute("name") ? element.Attribute("name") : element.Attribute("reference");
  Key key{name ? fmt::format("{} {}", element.Name(), name) : element.Name(), std::nullopt, element.GetLineNum()};
  if (element.GetText()) key.value = element.GetText();
  for (const auto* attribute = element.FirstAttribute(); attribute; attribute = attribute->Next())
    if (attribute->Value() != name)
      key.keys.push_back({attribute->Name(), attribute->Value(), attribute->GetLineNum()});
  for (const auto* child = element.FirstChildElement(); child; child = child->NextSiblingElement())
    key.keys.push_back(key_of(*child));
  number_equal_names(key.keys);
  return key;
}

std::optional<Key> root_of(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin != std::string::npos && text[begin] == '<') {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS || !document.RootElement())
      return std::nullopt;
    return key_of(*document.RootElement());
  }
  const auto root = parse_yaml(text, "");
  if (!root) return std::nullopt;
  Key key = key_of(**root, "", 1);
  std::erase_if(key.keys, [](const Key& of) { return only_judges(of.name); });
  return key;
}

/// Two numbers are compared as numbers.
bool are_equal(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto of_a = number_in<double>(a), of_b = number_in<double>(b);
  return of_a && of_b && *of_a == *of_b;
}

std::string shown(const Key& key) { return key.value ? printable(*key.value) : count_text(key.keys.size(), "key"); }

class Changes {
 public:
  void compare(const Key& before, const Key& now, const std::string& path) {
    if (before.value.has_value() != now.value.has_value() || (now.value && !are_equal(*before.value, *now.value)))
      found_.push_back({path, now.line, fmt::format("{} is {}, was {}", path, shown(now), shown(before))});
    for (const Key& key : now.keys) {
      const std::string below = path.empty() ? key.name : path + "/" + key.name;
      if (const Key* earlier = find(before, key.name))
        compare(*earlier, key, below);
      else
        found_.push_back(
            {below, key.line,
             key.value ? fmt::format("{} is {}, and is new", below, shown(key)) : fmt::format("{} is new", below)});
    }
    for (const Key& key : before.keys) {
      const std::string below = path.empty() ? key.name : path + "/" + key.name;
      if (!find(now, key.name))
        gone_.push_back({below, 0, fmt::format("{} is gone{}", below, key.value ? ", was " + shown(key) : "")});
    }
  }

  std::vector<KeyChange> take() && {
    std::ranges::stable_sort(found_, {}, &KeyChange::line);
    found_.insert(found_.end(), gone_.begin(), gone_.end());
    return std::move(found_);
  }

 private:
  static const Key* find(const Key& in, const std::string& name) {
    const auto found = std::ranges::find(in.keys, name, &Key::name);
    return found == in.keys.end() ? nullptr : &*found;
  }

  std::vector<KeyChange> found_, gone_;
};

}  // namespace

std::vector<KeyChange> key_changes(const std::string& before, const std::string& now) {
  const auto then = root_of(before), here = root_of(now);
  if (!then || !here) return {};
  Changes changes;
  changes.compare(*then, *here, "");
  return std::move(changes).take();
}

std::string to_string(const KeyChange& change, const std::string& file) {
  return change.line > 0 ? fmt::format("{}:{} ({})", file, change.line, change.text)
                         : fmt::format("{} ({})", file, change.text);
}

}  // namespace rehearse
