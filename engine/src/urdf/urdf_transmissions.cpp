#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <string>

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

std::string describe(const XMLElement& transmission) {
  const XMLElement* joint = transmission.FirstChildElement("joint");
  const char* name = joint == nullptr ? nullptr : joint->Attribute("name");
  std::string text = name == nullptr ? "no joint" : in_quotes(name);
  const std::string_view interface = find_text(transmission, "hardwareInterface");
  const std::string_view reduction = find_text(transmission, "mechanicalReduction");
  if (!interface.empty()) text += " by " + printable(interface);
  if (!reduction.empty() && parse_number(reduction) != 1.0) text += ", reduction " + printable(reduction);
  return text;
}

}  // namespace

void note_transmissions(const XMLElement& robot, Findings& findings) {
  const XMLElement* const first = robot.FirstChildElement("transmission");
  int count = 0;
  std::string listed;
  for (const auto* each = first; each != nullptr; each = each->NextSiblingElement("transmission")) {
    if (++count <= most_listed) listed += (count == 1 ? "" : "; ") + describe(*each);
  }
  if (count == 0) return;
  if (count > most_listed) listed += fmt::format("; and {} more", count - most_listed);
  findings.note(first->GetLineNum(), fmt::format("{} {} passed over, commands go straight to the joints: {}", count,
                                                 count == 1 ? "transmission is" : "transmissions are", listed));
}

}  // namespace rehearse::urdf
