// Finds the shape of a contact sensor. The sensor names a collision shape of another simulator's world, where links
// that fixed joints connect are merged. Gazebo gives the merged shapes new names, PyBullet keeps their names.
#include "urdf_devices.h"
#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

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
  std::optional<int> number = 0;
  if (!rest.empty()) number = rest.front() == '_' ? number_in<int>(rest.substr(1)) : std::nullopt;
  if (!number || *number < 0) return std::nullopt;
  name = name.substr(0, place);
  return number;
}

}  // namespace

MergedShapes::MergedShapes(const Model& model, const RigidGroups& groups, int group) : model_(model) {
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (groups.links[i].group != group) continue;
    const Link& link = model.links[i];
    const auto index = static_cast<int>(i);
    links_.emplace(link.name, MergedLink{index, shape_count_});
    shape_count_ += static_cast<int>(link.collisions.size());
    for (std::size_t shape = 0; shape < link.collisions.size(); ++shape)
      if (!link.collisions[shape].name.empty())
        shapes_.emplace(std::pair(std::string_view(link.collisions[shape].name), index), static_cast<int>(shape));
  }
}

std::optional<NamedShape> MergedShapes::find_named(std::string_view name, int own) const {
  auto found = shapes_.find({name, own});
  if (found == shapes_.end()) found = shapes_.lower_bound({name, 0});
  if (found == shapes_.end() || found->first.first != name) return std::nullopt;
  return NamedShape{found->first.second, found->second};
}

std::optional<NamedShape> MergedShapes::find(std::string_view name, int own) const {
  if (const std::size_t scope = name.rfind("::"); scope != std::string_view::npos) name = name.substr(scope + 2);
  if (const auto exact = find_named(name, own)) return exact;
  const std::size_t lumped = name.find(lump);
  if (lumped != std::string_view::npos) name = name.substr(lumped + lump.size());
  if (const auto exact = find_named(name, own)) return exact;
  const auto number = take_ending(name);
  if (!number) return std::nullopt;
  if (const auto named = find_named(name, own)) return named;
  const auto found = links_.find(name);
  if (found == links_.end()) return std::nullopt;
  const auto [link, first] = found->second;
  const auto count = static_cast<int>(model_.links[static_cast<std::size_t>(link)].collisions.size());
  if (lumped != std::string_view::npos && count == 1) return NamedShape{link, 0};
  const int shape = lumped != std::string_view::npos ? *number - first : *number;
  if (shape < 0 || shape >= count) return std::nullopt;
  return NamedShape{link, shape};
}

std::string_view unmerged(std::string_view link) {
  const std::size_t place = link.find(lump);
  return place == std::string_view::npos ? link : link.substr(place + lump.size());
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

/// The shapes of one link that the sensor names; nullopt with a warning if it names something else.
std::optional<std::set<NamedShape>> named_shapes(const DeviceDraft& draft, const Device& device, const Link& link,
                                                 const MergedShapes& merged, Findings& findings) {
  const std::string sensor = "contact sensor " + in_quotes(device.name);
  const std::string all = fmt::format("; contacts of all shapes of link {} count", in_quotes(link.name));
  std::set<NamedShape> shapes;
  for (const std::string& name : draft.collisions) {
    const auto shape = merged.find(name, device.link);
    if (!shape) {
      findings.warning(draft.device.line, fmt::format("{} names the collision shape {}, which link {} doesn't have{}",
                                                      sensor, in_quotes(name), in_quotes(link.name), all));
      return std::nullopt;
    }
    shapes.insert(*shape);
  }
  if (!shapes.empty() && shapes.begin()->link != shapes.rbegin()->link) {
    findings.warning(draft.device.line, fmt::format("{} names collision shapes of several links{}", sensor, all));
    return std::nullopt;
  }
  return shapes;
}

void set_feeling_shape(const DeviceDraft& draft, const Model& model, const RigidGroups& groups,
                       const MergedShapes& merged, Device& device, Findings& findings) {
  const auto link_of = [&](const Device& of) -> const Link& { return model.links[static_cast<std::size_t>(of.link)]; };
  const auto place_of = [&](int link) { return groups.links[static_cast<std::size_t>(link)].in_group; };
  const auto shapes = named_shapes(draft, device, link_of(device), merged, findings);
  if (shapes && !shapes->empty() && shapes->begin()->link != device.link) {
    const int link = shapes->begin()->link;
    device.pose = place_of(link).inverse() * place_of(device.link) * device.pose;
    device.link = link;
  }
  const Link& link = link_of(device);
  const std::string sensor = "contact sensor " + in_quotes(draft.device.name);
  if (link.collisions.empty()) {
    findings.warning(draft.device.line,
                     fmt::format("{} measures nothing: link {} has no collision shape", sensor, in_quotes(link.name)));
  } else if (shapes && shapes->size() == 1 && link.collisions.size() > 1) {
    std::get<ContactSensor>(device.kind).collision = shapes->begin()->collision;
  } else if (shapes && shapes->size() > 1 && shapes->size() < link.collisions.size()) {
    findings.warning(draft.device.line,
                     fmt::format("{} names {} of {} collision shapes; contacts of all shapes of link {} count", sensor,
                                 shapes->size(), link.collisions.size(), in_quotes(link.name)));
  }
}

}  // namespace rehearse::urdf
