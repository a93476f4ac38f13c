// Finds the shape of a contact sensor. The sensor names a collision shape of Gazebo's world. There, shapes of links
// behind fixed joints are moved to the link that moves, and shapes without a name have received one.
#include "urdf_devices.h"
#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <charconv>
#include <set>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr std::string_view ending = "_collision";
constexpr std::string_view lump = "_fixed_joint_lump__";

/// Removes "_collision" or "_collision_N" from the end. Returns N, or 0 without a number; nullopt if the name ends
/// otherwise.
std::optional<int> take_ending(std::string_view& name) {
  const std::size_t place = name.rfind(ending);
  if (place == std::string_view::npos) return std::nullopt;
  const std::string_view rest = name.substr(place + ending.size());
  int number = 0;
  if (!rest.empty()) {
    const auto [end, problem] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), number);
    const bool is_number = rest.size() > 1 && rest.front() == '_' && problem == std::errc() &&
                           end == rest.data() + rest.size() && number >= 0;
    if (!is_number) return std::nullopt;
  }
  name = name.substr(0, place);
  return number;
}

/// Index of the shape with this name in Gazebo, or -1: its name; LINK_collision and LINK_collision_N; and the same, or
/// the shape's name with "_collision", after OTHER_LINK_fixed_joint_lump__. The part before a "::" is a scope.
int find_shape_of_gazebo(const Link& link, const ShapeNames& shapes, std::string_view name) {
  if (const std::size_t scope = name.rfind("::"); scope != std::string_view::npos) name = name.substr(scope + 2);
  if (const int exact = shapes.find(name); exact >= 0) return exact;
  if (const std::size_t lumped = name.find(lump); lumped != std::string_view::npos) {
    name = name.substr(lumped + lump.size());
    if (const int exact = shapes.find(name); exact >= 0) return exact;
  }
  const auto number = take_ending(name);
  if (!number) return -1;
  if (const int named = shapes.find(name); named >= 0) return named;
  return name == link.name && *number < static_cast<int>(link.collisions.size()) ? *number : -1;
}

}  // namespace

ShapeNames::ShapeNames(const Link& link) {
  for (std::size_t i = 0; i < link.collisions.size(); ++i) {
    if (!link.collisions[i].name.empty()) shapes_.emplace(link.collisions[i].name, static_cast<int>(i));
  }
}

int ShapeNames::find(std::string_view name) const {
  const auto found = shapes_.find(name);
  return found == shapes_.end() ? -1 : found->second;
}

void read_contact_sensor(const XMLElement& sensor, DeviceDraft& draft, Findings& findings) {
  const XMLElement* contact = sensor.FirstChildElement("contact");
  if (contact == nullptr) return;
  report_ignored(*contact, {"collision"}, findings);
  for (const auto* child = contact->FirstChildElement("collision"); child != nullptr;
       child = child->NextSiblingElement("collision")) {
    draft.collisions.emplace_back(text_of(*child));
  }
}

int find_feeling_shape(const DeviceDraft& draft, const Link& link, const ShapeNames& names, Findings& findings) {
  const std::string sensor = "contact sensor " + in_quotes(draft.device.name);
  const std::string all = fmt::format("; all shapes of link {} feel", in_quotes(link.name));
  if (link.collisions.empty()) {
    findings.warning(draft.device.line,
                     fmt::format("{} feels nothing: link {} has no collision shape", sensor, in_quotes(link.name)));
    return -1;
  }
  std::set<int> shapes;
  for (const std::string& name : draft.collisions) {
    const int shape = find_shape_of_gazebo(link, names, name);
    if (shape < 0) {
      findings.warning(draft.device.line, fmt::format("{} names the collision shape {}, which link {} doesn't have{}",
                                                      sensor, in_quotes(name), in_quotes(link.name), all));
      return -1;
    }
    shapes.insert(shape);
  }
  if (shapes.empty() || shapes.size() == link.collisions.size()) return -1;
  if (shapes.size() == 1) return *shapes.begin();
  findings.warning(draft.device.line, fmt::format("{} names {} of {} collision shapes{}", sensor, shapes.size(),
                                                  link.collisions.size(), all));
  return -1;
}

}  // namespace rehearse::urdf
