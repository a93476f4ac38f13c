#include "urdf_materials.h"

#include "urdf_meshes.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

struct Mention {
  const XMLElement* element = nullptr;
  std::string name;
  Appearance appearance;
  bool has_texture = false;  // whether or not it can be used
};

std::vector<const XMLElement*> all_materials(const XMLElement& robot) {
  std::vector<const XMLElement*> found;
  for (const auto* part = robot.FirstChildElement(); part != nullptr; part = part->NextSiblingElement()) {
    const std::string_view kind = part->Name();
    if (kind == "material") found.push_back(part);
    if (kind != "link") continue;
    for (const auto* visual = part->FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual")) {
      if (const auto* material = visual->FirstChildElement("material")) found.push_back(material);
    }
  }
  return found;
}

std::optional<Color> read_color(const XMLElement& material, Findings& findings) {
  const XMLElement* element = material.FirstChildElement("color");
  if (element == nullptr) return std::nullopt;
  const char* text = element->Attribute("rgba");
  const auto rgb = parse_numbers(text == nullptr ? "" : text, 3);
  if (rgb) findings.repair(element->GetLineNum(), fmt::format("rgba {} gets an alpha of 1", in_quotes(text)));
  const auto rgba =
      rgb ? Eigen::Vector4d((*rgb)[0], (*rgb)[1], (*rgb)[2], 1.0) : read_vector4(*element, "rgba", findings);
  if (!rgba) return std::nullopt;
  const Eigen::Vector4d clamped = rgba->cwiseMax(0.0).cwiseMin(1.0);
  if (clamped != *rgba) {
    findings.repair(element->GetLineNum(),
                    fmt::format("rgba {} is brought into 0 to 1", in_quotes(element->Attribute("rgba"))));
  }
  return clamped.cast<float>();
}

Mention read_mention(const XMLElement& element, Meshes& meshes, Findings& findings) {
  Mention mention{&element, "", {read_color(element, findings), nullptr}, false};
  if (const XMLElement* texture = element.FirstChildElement("texture")) {
    mention.has_texture = true;
    mention.appearance.texture = meshes.read_texture(*texture);
  }
  if (const char* name = element.Attribute("name")) {
    mention.name = name;
  } else if (mention.appearance.says_something()) {
    findings.repair(element.GetLineNum(), "a material without a name; its colour is used in this place only");
  } else {
    findings.repair(element.GetLineNum(), "a material with neither name nor colour is left out");
  }
  return mention;
}

/// Reports later definitions of a name that already has a colour.
void report_doubles(const std::vector<Mention>& mentions, Findings& findings) {
  std::map<std::string, const Mention*> defined;
  for (const Mention& mention : mentions) {
    if (mention.name.empty() || !mention.appearance.color) continue;
    const Mention*& last = defined[mention.name];
    if (last != nullptr && *last->appearance.color == *mention.appearance.color) {
      findings.ignored(mention.element->GetLineNum(), "a material defined again with the same colour");
    } else if (last != nullptr) {
      findings.repair(mention.element->GetLineNum(),
                      fmt::format("material {} has another colour in line {}; from here on this colour applies",
                                  in_quotes(mention.name), last->element->GetLineNum()));
    }
    last = &mention;
  }
}

}  // namespace

Materials::Materials(const XMLElement& robot, Meshes& meshes, Findings& findings) {
  std::vector<Mention> mentions;
  for (const XMLElement* element : all_materials(robot)) mentions.push_back(read_mention(*element, meshes, findings));
  report_doubles(mentions, findings);

  std::map<std::string, Appearance> known;  // the first definition of each name, until a later one has been read
  for (const Mention& mention : mentions) {
    if (!mention.name.empty() && mention.appearance.says_something()) known.emplace(mention.name, mention.appearance);
  }
  for (const Mention& mention : mentions) {
    if (mention.appearance.says_something()) {
      appearances_[mention.element] = mention.appearance;
      if (!mention.name.empty()) known[mention.name] = mention.appearance;
    } else if (const auto found = known.find(mention.name); found != known.end()) {
      appearances_[mention.element] = found->second;
    } else if (!mention.name.empty() && !mention.has_texture) {
      findings.warning(mention.element->GetLineNum(),
                       fmt::format("material {} has no colour anywhere in the file", in_quotes(mention.name)));
    }
  }
}

Appearance Materials::of(const XMLElement& visual) const {
  const XMLElement* material = visual.FirstChildElement("material");
  const auto found = appearances_.find(material);
  return found == appearances_.end() ? Appearance{} : found->second;
}

}  // namespace rehearse::urdf
