// The tree of items of a project file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body/body_mapping.h"
#include "yaml/yaml_tree.h"

namespace rehearse::import {

struct ProjectItem {
  std::string name;
  std::string type;                // its class
  const YamlNode* node = nullptr;  // never null
  const YamlNode* data = nullptr;  // null: it has none
  const ProjectItem* parent = nullptr;
  std::vector<std::unique_ptr<ProjectItem>> children;

  /// True for all items that simulate a world.
  bool is_simulator() const;
  /// True for items that act within one of these, as vision simulators do.
  bool is_sub_simulator() const;
  bool is_below(const ProjectItem& other) const;
  /// The nearest item of that class above this one, or null.
  const ProjectItem* above(std::string_view wanted) const;
};

struct ProjectFile {
  explicit ProjectFile(const std::string& name) : document(name, false) {}

  body::Document document;
  ProjectItem root;
  double frame_rate = 1000.0;  // of the time bar [Hz]
  double max_time = 30.0;      // likewise [s]
  bool has_time_bar = false;
  const YamlNode* wrong_time_bar = nullptr;  // without a positive rate and length: an error if the run needs it

  /// Takes the time bar of another file, which Choreonoid has loaded later.
  void take_time_bar(const ProjectFile& other);
  /// All items but the root, in document order.
  std::vector<const ProjectItem*> all() const;
};

/// Reads the tree; errors are in the document's findings.
std::unique_ptr<ProjectFile> read_project_file(const std::string& text, const std::string& name);

/// The keys of an item's data; of an item without data it is empty.
body::Mapping data_of(const ProjectItem& item, ProjectFile& file);

}  // namespace rehearse::import
