// Choreonoid's tables of contact materials.
#pragma once

#include <array>
#include <map>
#include <set>
#include <string>

#include "body/body_mapping.h"

namespace rehearse::import {

struct ContactProperties {
  double friction = 0.5;
  double restitution = 0.0;
  bool operator==(const ContactProperties&) const = default;
};

class ContactMaterials {
 public:
  /// Adds a table; its entries replace earlier ones.
  void read(const YamlNode& root, body::Document& document);

  /// The pair that Choreonoid's own table begins with: Default with itself has the friction 0.5.
  void add_default_pair() { pairs_[{"Default", "Default"}] = {}; }

  /// Friction and restitution between two materials. If the pair isn't listed, the friction is the geometric mean of
  /// both roughnesses, and the restitution that of 1 minus each viscosity. A name that no table has counts as Default.
  ContactProperties between(const std::string& a, const std::string& b) const;

 private:
  struct Material {
    double roughness = 0.5;
    double viscosity = 1.0;
  };
  void read_pair(body::Mapping& keys, body::Document& document);
  const Material& material(const std::string& name) const;

  std::map<std::string, Material> materials_{{"Default", {1.0, 1.0}}};
  std::map<std::array<std::string, 2>, ContactProperties> pairs_;  // names ascending
};

/// The name of a material in the tables: Default for an empty name and for `default`, else unchanged.
std::string material_name(const std::string& written);

}  // namespace rehearse::import
