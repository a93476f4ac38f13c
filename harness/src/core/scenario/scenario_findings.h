// Findings: the mistakes in a scenario file, collected in any order and reported in document order; and the defaults of
// the keys that it doesn't state, which can be varied.
#pragma once

#include <rehearse/diagnostic.h>

#include "yaml/yaml_tree.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

class Findings {
 public:
  explicit Findings(std::string file) : file_(std::move(file)) {}

  /// `details` stay with the finding when it is sorted: the messages of a model's own loader.
  void error(const YamlNode& at, std::string message, std::string hint = {}, Diagnostics details = {});
  void warning(const YamlNode& at, std::string message, std::string hint = {});
  /// Warnings with a place in a different file; `at` only determines their order among the findings of this file.
  void pass_through(const YamlNode& at, Diagnostics warnings);

  bool any_error() const { return !errors_.empty(); }
  /// In document order; the first 20 with their details, then a note with the number of omitted ones.
  Diagnostics errors() const;
  /// In document order, all of them.
  Diagnostics warnings() const;

  /// The default of a key that a map doesn't state, as it would be written: one element, or those of a list.
  void set_default(const YamlNode& map, std::string_view key, std::vector<std::string> elements);
  /// Null: the key has none, or is stated.
  const std::vector<std::string>* find_default(const YamlNode& map, const std::string& key) const;
  /// The keys of a map that aren't stated: those with a default, and those of absent maps.
  std::vector<std::string> unstated_keys(const YamlNode& map) const;
  /// An empty map in place of one that `map` doesn't state under this key: keys read from it have their defaults.
  const YamlNode& absent_map(const YamlNode& map, const std::string& key);
  /// Null: there is none.
  const YamlNode* find_absent_map(const YamlNode& map, const std::string& key) const;

 private:
  using KeyOfMap = std::pair<const YamlNode*, std::string>;

  struct Finding {
    int line;
    int column;
    Diagnostics lines;
  };
  static std::vector<Finding> in_document_order(std::vector<Finding> findings);

  std::string file_;
  std::vector<Finding> errors_;
  std::vector<Finding> warnings_;
  std::map<KeyOfMap, std::vector<std::string>> defaults_;
  std::map<KeyOfMap, YamlNodePtr> absent_maps_;
};

}  // namespace rehearse
