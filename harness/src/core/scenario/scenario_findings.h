// Findings: the mistakes in a scenario file, collected in any order and reported in document order.
#pragma once

#include <rehearse/diagnostic.h>

#include "yaml/yaml_tree.h"

#include <string>
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

 private:
  struct Finding {
    int line;
    int column;
    Diagnostics lines;
  };
  static std::vector<Finding> in_document_order(std::vector<Finding> findings);

  std::string file_;
  std::vector<Finding> errors_;
  std::vector<Finding> warnings_;
};

}  // namespace rehearse
