#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr int most_listed = 8;

/// The text of a child of one of the transmission's parts, at any depth; empty if there is none.
std::string_view find_text(const XMLElement& transmission, const char* name) {
  for (const auto* part = transmission.FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
    if (const auto* child = part->FirstChildElement(name)) return text_of(*child);
  }
  return {};
}

constexpr std::initializer_list<const char*> rotor_names = {"drake:rotor_inertia", "rotor_inertia", "rotorInertia"};

bool has_rotor(const XMLElement& transmission) {
  return std::ranges::any_of(rotor_names, [&](const char* name) { return !find_text(transmission, name).empty(); });
}

std::string describe(const XMLElement& transmission) {
  const XMLElement* joint = transmission.FirstChildElement("joint");
  const char* name = joint == nullptr ? nullptr : joint->Attribute("name");
  std::string text = name == nullptr ? "no joint" : in_quotes(name);
  const std::string_view interface = find_text(transmission, "hardwareInterface");
  const std::string_view reduction = find_text(transmission, "mechanicalReduction");
  if (!interface.empty()) text += " by " + printable(interface);
  if (!reduction.empty() && parse_number(reduction) != 1.0)
    text += ", reduction " + printable(reduction) + (has_rotor(transmission) ? "" : " without effect");
  return text;
}

/// A number above 0 under any of the names; nothing, with a warning, if the text is not a number above 0.
std::optional<double> read_positive(const XMLElement& transmission, std::initializer_list<const char*> names,
                                    Findings& findings) {
  for (const char* name : names) {
    const std::string_view text = find_text(transmission, name);
    if (text.empty()) continue;
    const auto number = parse_number(text);
    if (number && *number > 0.0) return number;
    findings.warning(transmission.GetLineNum(),
                     fmt::format("the {} of a <transmission> is {}, not a number above 0; it is passed over", tag(name),
                                 in_quotes(text)));
    return std::nullopt;
  }
  return std::nullopt;
}

/// Drake's elements, or those without its prefix.
std::optional<RotorInertiaDraft> read_rotor(const XMLElement& transmission, Findings& findings) {
  if (!has_rotor(transmission)) return std::nullopt;
  const auto inertia = read_positive(transmission, rotor_names, findings);
  const auto ratio = read_positive(transmission, {"drake:gear_ratio", "gear_ratio", "mechanicalReduction"}, findings);
  const XMLElement* joint = transmission.FirstChildElement("joint");
  const auto name = joint == nullptr ? std::nullopt : read_name(*joint, "name", findings);
  if (!inertia || !name) return std::nullopt;
  return RotorInertiaDraft{*name, *inertia, ratio.value_or(1.0), transmission.GetLineNum()};
}

}  // namespace

std::vector<RotorInertiaDraft> read_transmissions(const XMLElement& robot, Findings& findings) {
  const XMLElement* const first = robot.FirstChildElement("transmission");
  int count = 0;
  std::string listed;
  std::vector<RotorInertiaDraft> rotors;
  for (const auto* each = first; each != nullptr; each = each->NextSiblingElement("transmission")) {
    if (++count <= most_listed) listed += (count == 1 ? "" : "; ") + describe(*each);
    if (auto rotor = read_rotor(*each, findings)) rotors.push_back(std::move(*rotor));
  }
  if (count == 0) return rotors;
  if (count > most_listed) listed += fmt::format("; and {} more", count - most_listed);
  findings.note(first->GetLineNum(), fmt::format("{} {} passed over, commands go straight to the joints: {}", count,
                                                 count == 1 ? "transmission is" : "transmissions are", listed));
  return rotors;
}

}  // namespace rehearse::urdf
