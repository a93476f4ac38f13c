// Findings: the mistakes in a scenario file, collected in any order and reported in document order.
#pragma once

#include <rehearse/diagnostic.h>

#include "scenario_yaml.h"

#include <string>
#include <string_view>
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

/// The names that are most similar to `wanted`, nearest first, at most three.
std::vector<std::string> near_names(std::string_view wanted, const std::vector<std::string>& names);

/// A hint for an unknown name: "did you mean 'a' or 'b'?", else the list of names: "known KIND: a, b, c".
std::string name_hint(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind);

}  // namespace rehearse
