// Findings: what a scenario file has wrong with it, gathered in any order and told in the file's.
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

  /// `details` follow the finding wherever it is sorted to: what a model's own loader had to say.
  void error(const YamlNode& at, std::string message, std::string hint = {}, Diagnostics details = {});
  void warning(const YamlNode& at, std::string message, std::string hint = {});
  /// Warnings that have a place of their own, in another file; `at` only decides where they stand among ours.
  void pass_through(const YamlNode& at, Diagnostics warnings);

  bool any_error() const { return !errors_.empty(); }
  /// In document order; the first 20 with their details, then a note of how many were left out.
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

/// The names that someone who wrote `wanted` may have meant, nearest first, at most three.
std::vector<std::string> near_names(std::string_view wanted, const std::vector<std::string>& names);

/// A hint for an unknown name: "did you mean 'a' or 'b'?", else what there is: "known KIND: a, b, c".
std::string name_hint(std::string_view wanted, const std::vector<std::string>& names, std::string_view kind);

}  // namespace rehearse
