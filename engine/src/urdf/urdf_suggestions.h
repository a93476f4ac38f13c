// Suggestions: hints about names in a URDF file that don't exist.
#pragma once

#include <rehearse/model.h>
#include <rehearse/urdf.h>

#include <string>
#include <string_view>
#include <vector>

#include "base/names.h"
#include "base/text.h"

namespace rehearse::urdf {

class Suggestions {
 public:
  /// `kind`: a plural, as in "links".
  explicit Suggestions(std::string_view kind) : kind_(kind) {}

  void add(std::string_view name) { names_.push_back(printable(name)); }

  /// The names that are most similar to `wanted`, or a list of all. Empty after max_urdf_errors hints: each compares
  /// `wanted` with all names, and more hints are of no use.
  std::string of(std::string_view wanted) { return left_-- > 0 ? name_hint(wanted, names_, kind_) : std::string(); }

 private:
  std::string_view kind_;
  std::vector<std::string> names_;
  int left_ = max_urdf_errors;
};

inline Suggestions links_of(const Model& model) {
  Suggestions links("links");
  for (const Link& link : model.links) links.add(link.name);
  return links;
}

}  // namespace rehearse::urdf
