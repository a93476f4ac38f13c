#include "urdf_schema.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <set>
#include <vector>

#include "urdf_values.h"

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

struct Rule {
  std::string_view element;
  std::vector<std::string_view> attributes;
  std::vector<std::string_view> children;  // each once at most
  std::vector<std::string_view> repeated;  // any number of times
};

/// An element has the same meaning at every place, so the table uses only its name.
const std::vector<Rule>& rules() {
  static const std::vector<Rule> table = {
      {"robot",
       {"name", "version"},
       {},
       {"link", "joint", "material", "gazebo", "sensor", "transmission", "loop_joint"}},
      {"link", {"name"}, {"inertial"}, {"visual", "collision", "contact"}},
      {"inertial", {}, {"origin", "mass", "inertia"}, {}},
      {"mass", {"value"}, {}, {}},
      {"inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {}, {}},
      {"visual", {"name"}, {"origin", "geometry", "material"}, {}},
      {"collision", {"name", "concave"}, {"origin", "geometry"}, {}},
      {"contact",
       {},
       {"lateral_friction", "spinning_friction", "rolling_friction", "stiffness", "damping", "restitution"},
       {}},
      {"lateral_friction", {"value"}, {}, {}},
      {"spinning_friction", {"value"}, {}, {}},
      {"rolling_friction", {"value"}, {}, {}},
      {"stiffness", {"value"}, {}, {}},
      {"damping", {"value"}, {}, {}},
      {"restitution", {"value"}, {}, {}},
      {"material", {"name"}, {"color", "texture"}, {}},
      {"texture", {"filename"}, {}, {}},
      {"color", {"rgba"}, {}, {}},
      {"joint",
       {"name", "type"},
       {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller"},
       {}},
      {"origin", {"xyz", "rpy", "quat_xyzw"}, {}, {}},
      {"parent", {"link"}, {}, {}},
      {"child", {"link"}, {}, {}},
      {"axis", {"xyz"}, {}, {}},
      {"limit", {"lower", "upper", "effort", "velocity"}, {}, {}},
      {"dynamics", {"damping", "friction", "armature"}, {}, {}},
      {"safety_controller", {"soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"}, {}, {}},
      {"mimic", {"joint", "multiplier", "offset"}, {}, {}},
  };
  return table;
}

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

const Rule* find_rule(std::string_view element) {
  const auto& table = rules();
  const auto found = std::ranges::find_if(table, [&](const Rule& rule) { return rule.element == element; });
  return found == table.end() ? nullptr : &*found;
}

void prune_attributes(XMLElement& element, const Rule& rule, Findings& findings) {
  std::vector<std::string> unknown;
  for (const auto* attribute = element.FirstAttribute(); attribute != nullptr; attribute = attribute->Next()) {
    const std::string_view name = attribute->Name();
    if (contains(rule.attributes, name)) continue;
    unknown.emplace_back(name);
    if (name == "xmlns" || name.starts_with("xmlns:")) continue;
    findings.ignored(attribute->GetLineNum(), fmt::format("attribute {} of <{}>", in_quotes(name), rule.element));
  }
  for (const std::string& name : unknown) element.DeleteAttribute(name.c_str());
}

/// Reports the parts of an unknown child that are lost with it.
void report_unknown(const XMLNode& child, const Rule& rule, Findings& findings) {
  if (const XMLElement* element = child.ToElement()) {
    findings.ignored(element->GetLineNum(), fmt::format("<{}>{}", rule.element, tag(element->Name())));
  } else if (const auto* text = child.ToText()) {
    if (std::string_view(text->Value()).find_first_not_of(" \t\r\n") == std::string_view::npos) return;
    findings.ignored(text->GetLineNum(), fmt::format("text between the elements of <{}>", rule.element));
  }
}

void prune(XMLElement& element, const Rule& rule, Findings& findings) {
  prune_attributes(element, rule, findings);
  std::set<std::string_view> seen;
  XMLNode* next = nullptr;
  for (XMLNode* child = element.FirstChild(); child != nullptr; child = next) {
    next = child->NextSibling();
    XMLElement* inner = child->ToElement();
    const std::string_view name = inner == nullptr ? std::string_view() : std::string_view(inner->Name());
    const bool is_single = contains(rule.children, name);
    if (!is_single && !contains(rule.repeated, name)) {
      report_unknown(*child, rule, findings);
      element.DeleteChild(child);
      continue;
    }
    const bool is_second = is_single && !seen.insert(name).second;
    // the choice between two of these would change the robot's tree, masses or shapes
    const bool is_ambiguous = is_second && is_one_of(name, {"inertial", "geometry", "parent", "child"});
    if (is_second && !is_ambiguous) {
      findings.repair(inner->GetLineNum(),
                      fmt::format("a second <{}> in one <{}>; the first counts", name, rule.element));
      element.DeleteChild(child);
      continue;
    }
    if (is_ambiguous) {
      findings.error(inner->GetLineNum(), fmt::format("a second <{}> in one <{}>", name, rule.element));
    }
    if (const Rule* inner_rule = find_rule(name)) prune(*inner, *inner_rule, findings);
  }
}

}  // namespace

bool is_read(std::string_view element) { return find_rule(element) != nullptr; }

void prune_to_schema(XMLElement& robot, Findings& findings) { prune(robot, *find_rule("robot"), findings); }

}  // namespace rehearse::urdf
