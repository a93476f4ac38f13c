#include "contact_materials.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rehearse::import {
namespace {

std::array<std::string, 2> pair_key(const std::string& a, const std::string& b) {
  return a < b ? std::array{a, b} : std::array{b, a};
}

}  // namespace

std::string material_name(const std::string& written) {
  return written.empty() || written == "default" ? "Default" : written;
}

void ContactMaterials::read(const YamlNode& root, body::Document& document) {
  body::Mapping keys(root, "a table of materials", document);
  const auto each = [&](const YamlNode* list, const char* label, const auto& use) {
    if (list == nullptr) return;
    if (list->kind != YamlNode::Kind::list) return document.error(*list, std::string(label) + " isn't a list");
    for (const YamlNodePtr& item : list->items) {
      body::Mapping entry(*item, "a material", document);
      if (entry.is_map()) use(entry);
    }
  };
  each(keys.find({"materials"}), "materials", [&](body::Mapping& entry) {
    Material material;
    material.roughness = std::max(0.0, entry.soft_number({"roughness"}, material.roughness));
    material.viscosity = std::clamp(entry.soft_number({"viscosity"}, material.viscosity), 0.0, 1.0);
    materials_[material_name(entry.text({"name"}).value_or(""))] = material;
  });
  each(keys.find({"contact_materials", "contactMaterials"}), "contact_materials",
       [&](body::Mapping& entry) { read_pair(entry, document); });
}

void ContactMaterials::read_pair(body::Mapping& keys, body::Document& document) {
  ContactProperties properties;
  double friction = keys.soft_number({"static_friction", "staticFriction"}, properties.friction);
  friction = keys.soft_number({"dynamic_friction", "dynamicFriction"}, friction);
  properties.friction = std::clamp(keys.soft_number({"friction"}, friction), 0.0, 1e6);
  properties.restitution = std::clamp(keys.soft_number({"restitution"}, 0.0), 0.0, 1.0);
  const YamlNode* list = keys.find({"materials"});
  if (list == nullptr || list->kind != YamlNode::Kind::list || list->items.size() < 2)
    return document.error(keys.node(), "a contact material doesn't name two materials", "materials: [Ground, Sole]");
  std::vector<std::string> names;
  for (const YamlNodePtr& item : list->items) names.push_back(material_name(item->text));
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = i + 1; j < names.size(); ++j) pairs_[pair_key(names[i], names[j])] = properties;
}

const ContactMaterials::Material& ContactMaterials::material(const std::string& name) const {
  const auto known = materials_.find(name);
  return known == materials_.end() ? materials_.at("Default") : known->second;
}

ContactProperties ContactMaterials::between(const std::string& a, const std::string& b) const {
  if (const auto listed = pairs_.find(pair_key(a, b)); listed != pairs_.end()) return listed->second;
  const Material &one = material(a), &other = material(b);
  return {std::sqrt(one.roughness * other.roughness), std::sqrt((1.0 - one.viscosity) * (1.0 - other.viscosity))};
}

}  // namespace rehearse::import
