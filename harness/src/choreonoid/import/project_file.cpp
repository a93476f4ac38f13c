#include "project_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>

#include "base/text.h"

namespace rehearse::import {
namespace {

using body::Mapping;

constexpr std::string_view simulator_class = "SimulatorItem";  // the end of its name
constexpr std::string_view known_sub_simulators[] = {"GLVisionSimulatorItem", "MulticopterSimulatorItem",
                                                     "SubmersibleSimulatorItem", "SampleCameraEffectSimulatorItem"};

void read_item(const YamlNode& node, ProjectFile& file, ProjectItem& item) {
  Mapping keys(node, "an item", file.document);
  item.node = &node;
  item.name = keys.text({"name"}).value_or("");
  keys.text({"plugin"});  // only to report a mistake in it
  item.type = keys.text({"class"}).value_or("");
  if (keys.is_map() && item.type.empty() && !keys.find({"is_sub_item"}))
    file.document.error(node, fmt::format("the item {} has no class", in_quotes(item.name)), "class: BodyItem");
  item.data = keys.find({"data"});
  if (item.data != nullptr && item.data->kind != YamlNode::Kind::map) {
    file.document.error(*item.data, fmt::format("the data of the item {} isn't a mapping", in_quotes(item.name)));
    item.data = nullptr;
  }
  const YamlNode* children = keys.find({"children"});
  if (children == nullptr) return;
  if (children->kind != YamlNode::Kind::list)
    return file.document.error(*children,
                               fmt::format("the children of the item {} aren't a list", in_quotes(item.name)));
  for (const YamlNodePtr& child : children->items) {
    item.children.push_back(std::make_unique<ProjectItem>());
    item.children.back()->parent = &item;
    read_item(*child, file, *item.children.back());
  }
}

/// Reads the time bar, whose length and rate apply if the simulator item has none.
void read_time_bar(const YamlNode& toolbars, ProjectFile& file) {
  Mapping bars(toolbars, "the toolbars", file.document);
  const YamlNode* bar = bars.find({"TimeBar"});
  if (bar == nullptr) return;
  file.has_time_bar = true;
  Mapping keys(*bar, "the time bar", file.document);
  const double rate = keys.number({"frame_rate", "frameRate"}).value_or(file.frame_rate);
  const double length = keys.number({"max_time", "maxTime"}).value_or(file.max_time);
  if (rate > 0.0 && length > 0.0) {
    file.frame_rate = rate;
    file.max_time = length;
  } else {
    file.wrong_time_bar = bar;
  }
}

}  // namespace

bool ProjectItem::is_simulator() const { return type.ends_with(simulator_class) && !is_sub_simulator(); }

/// Plugins have sub-simulators of their own: what is below a simulator item is one.
bool ProjectItem::is_sub_simulator() const {
  if (!type.ends_with(simulator_class)) return false;
  if (std::ranges::find(known_sub_simulators, type) != std::end(known_sub_simulators)) return true;
  for (const ProjectItem* item = parent; item != nullptr; item = item->parent)
    if (item->type.ends_with(simulator_class)) return true;
  return false;
}

bool ProjectItem::is_below(const ProjectItem& other) const {
  for (const ProjectItem* item = parent; item != nullptr; item = item->parent)
    if (item == &other) return true;
  return false;
}

const ProjectItem* ProjectItem::above(std::string_view wanted) const {
  const ProjectItem* item = parent;
  while (item != nullptr && item->type != wanted) item = item->parent;
  return item;
}

void ProjectFile::take_time_bar(const ProjectFile& other) {
  if (!other.has_time_bar || other.wrong_time_bar != nullptr) return;
  frame_rate = other.frame_rate;
  max_time = other.max_time;
  wrong_time_bar = nullptr;
}

std::vector<const ProjectItem*> ProjectFile::all() const {
  std::vector<const ProjectItem*> items;
  const std::function<void(const ProjectItem&)> visit = [&](const ProjectItem& item) {
    for (const auto& child : item.children) {
      items.push_back(child.get());
      visit(*child);
    }
  };
  visit(root);
  return items;
}

std::unique_ptr<ProjectFile> read_project_file(const std::string& text, const std::string& name) {
  auto file = std::make_unique<ProjectFile>(name);
  body::Document& document = file->document;
  Result<YamlDocument> parsed = parse_yaml_document(text, name);
  if (!parsed) {
    const Diagnostic& problem = parsed.errors().front();
    document.findings().error(problem.line, problem.message, problem.hint);
    return file;
  }
  document.root = parsed->root;
  const auto is_project = [&](const YamlNode& root) {
    for (const YamlNodePtr& key : root.keys)
      if (key->text == "items" || key->text == "views" || key->text == "toolbars") return true;
    return false;
  };
  if (document.root->kind != YamlNode::Kind::map || !is_project(*document.root)) {
    document.error(*document.root, "it isn't a Choreonoid project", "a project has items, a mapping of the root item");
    return file;
  }
  Mapping keys(*document.root, "a project", document);
  if (const YamlNode* toolbars = keys.find({"toolbars"})) read_time_bar(*toolbars, *file);
  const YamlNode* items = keys.find({"items"});
  if (items != nullptr) read_item(*items, *file, file->root);
  if (file->root.node == nullptr) file->root.node = document.root.get();
  return file;
}

Mapping data_of(const ProjectItem& item, ProjectFile& file) {
  static const YamlNode nothing = [] {
    YamlNode node;
    node.kind = YamlNode::Kind::map;
    return node;
  }();
  return Mapping(item.data == nullptr ? nothing : *item.data, fmt::format("a {}", item.type), file.document);
}

}  // namespace rehearse::import
