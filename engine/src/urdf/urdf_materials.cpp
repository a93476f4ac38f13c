#include "urdf_materials.h"

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
  std::optional<Color> color;
  bool has_texture = false;
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
  const auto rgba = read_vector4(*element, "rgba", findings);
  if (!rgba) return std::nullopt;
  const Eigen::Vector4d clamped = rgba->cwiseMax(0.0).cwiseMin(1.0);
  if (clamped != *rgba) {
    findings.repair(element->GetLineNum(),
                    fmt::format("rgba {} is brought into 0 to 1", in_quotes(element->Attribute("rgba"))));
  }
  return clamped.cast<float>();
}

/// Warns of an ignored texture: only meshes have textures.
bool warn_of_texture(const XMLElement& material, Findings& findings) {
  const XMLElement* texture = material.FirstChildElement("texture");
  if (texture == nullptr) return false;
  const char* file = texture->Attribute("filename");
  findings.warning(texture->GetLineNum(),
                   fmt::format("the <texture> {} of a material isn't drawn", in_quotes(file == nullptr ? "" : file)));
  return true;
}

Mention read_mention(const XMLElement& element, Findings& findings) {
  Mention mention{&element, "", read_color(element, findings), warn_of_texture(element, findings)};
  if (const char* name = element.Attribute("name")) {
    mention.name = name;
  } else if (mention.color) {
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
    if (mention.name.empty() || !mention.color) continue;
    const Mention*& last = defined[mention.name];
    if (last != nullptr && *last->color == *mention.color) {
      findings.ignored(mention.element->GetLineNum(), "a material defined again with the same colour");
    } else if (last != nullptr) {
      findings.repair(mention.element->GetLineNum(),
                      fmt::format("material {} has another colour in line {}; from here on it has this one",
                                  in_quotes(mention.name), last->element->GetLineNum()));
    }
    last = &mention;
  }
}

}  // namespace

Materials::Materials(const XMLElement& robot, Findings& findings) {
  std::vector<Mention> mentions;
  for (const XMLElement* element : all_materials(robot)) mentions.push_back(read_mention(*element, findings));
  report_doubles(mentions, findings);

  std::map<std::string, Color> known;  // the first definition of each name, until a later one has been read
  for (const Mention& mention : mentions) {
    if (!mention.name.empty() && mention.color) known.emplace(mention.name, *mention.color);
  }
  for (const Mention& mention : mentions) {
    if (mention.color) {
      colors_[mention.element] = *mention.color;
      if (!mention.name.empty()) known[mention.name] = *mention.color;
    } else if (const auto found = known.find(mention.name); found != known.end()) {
      colors_[mention.element] = found->second;
    } else if (!mention.name.empty() && !mention.has_texture) {
      findings.warning(mention.element->GetLineNum(),
                       fmt::format("material {} has no colour anywhere in the file", in_quotes(mention.name)));
    }
  }
}

std::optional<Color> Materials::of(const XMLElement& visual) const {
  const XMLElement* material = visual.FirstChildElement("material");
  if (material == nullptr) return std::nullopt;
  const auto found = colors_.find(material);
  if (found == colors_.end()) return std::nullopt;
  return found->second;
}

}  // namespace rehearse::urdf
