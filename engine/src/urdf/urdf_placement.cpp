#include "urdf_devices.h"
#include "urdf_draft.h"
#include "urdf_suggestions.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace rehearse::urdf {
namespace {

/// The links of a model by name, and by the name of the joint above them.
struct Names {
  explicit Names(const Model& model) {
    for (std::size_t i = 0; i < model.links.size(); ++i) {
      links.emplace(model.links[i].name, static_cast<int>(i));
      if (i > 0) joints.emplace(model.links[i].joint.name, static_cast<int>(i));
    }
  }

  static int find(const std::map<std::string_view, int>& names, std::string_view name) {
    const auto found = names.find(name);
    return found == names.end() ? -1 : found->second;
  }

  /// Index of the link to which a device's reference refers, or -1. Gazebo's names of merged links are known.
  int link_of(const DeviceDraft& device) const {
    const int whole = find(links, device.reference);
    const int link = whole >= 0 ? whole : find(links, unmerged(device.reference));
    const int joint = find(joints, device.reference);
    switch (device.meaning) {
      case Reference::link: return link;
      case Reference::joint: return joint;
      case Reference::link_else_joint: return link >= 0 ? link : joint;
      case Reference::joint_else_link: return joint >= 0 ? joint : link;
    }
    REHEARSE_ASSERT(false, "a Reference outside its enumeration");
  }

  std::map<std::string_view, int> links;
  std::map<std::string_view, int> joints;
};

/// A device stores its pose in its own link, so it can have the parent's axes only if the joint doesn't turn them.
void turn_to_parents_axes(const Link& link, Device& device, Findings& findings) {
  if (link.joint.type == JointType::revolute || link.joint.type == JointType::continuous) {
    findings.warning(device.line,
                     fmt::format("sensor {} measures along the axes of its own link {}, not along those of the "
                                 "parent link, which joint {} turns",
                                 in_quotes(device.name), in_quotes(link.name), in_quotes(link.joint.name)));
  } else if (link.parent >= 0) {
    device.pose.linear() = link.joint.origin.linear().transpose();
  }
}

/// The shapes by rigid group, found on demand.
using AllMergedShapes = std::map<int, MergedShapes>;

void settle(const DeviceDraft& draft, const Model& model, const RigidGroups& groups, AllMergedShapes& merged,
            Device& device, Findings& findings) {
  const Link& link = model.links[static_cast<std::size_t>(device.link)];
  if (draft.has_parents_axes) turn_to_parents_axes(link, device, findings);
  if (!std::holds_alternative<ContactSensor>(device.kind)) return;
  const int group = groups.links[static_cast<std::size_t>(device.link)].group;
  const MergedShapes& of_group = merged.try_emplace(group, model, groups, group).first->second;
  set_feeling_shape(draft, model, groups, of_group, device, findings);
}

}  // namespace

void place_devices(const Draft& draft, Model& model, Findings& findings) {
  const Names names(model);
  const RigidGroups groups = group_links(model);
  AllMergedShapes merged;
  Suggestions links = links_of(model);
  for (const DeviceDraft& device : draft.devices) {
    const int link = names.link_of(device);
    if (link < 0) {
      const bool needs_joint = device.meaning == Reference::joint;
      findings.warning(
          device.device.line,
          fmt::format("{} {} is left out: it is on {}, which is not a {}", word_for(device.device),
                      in_quotes(device.device.name), in_quotes(device.reference), needs_joint ? "joint" : "link"),
          needs_joint ? "" : links.of(device.reference));
      continue;
    }
    Device& placed = model.devices.emplace_back(device.device);
    placed.link = link;
    settle(device, model, groups, merged, placed, findings);
  }
  std::ranges::stable_sort(model.devices, [](const Device& a, const Device& b) { return a.link < b.link; });
}

}  // namespace rehearse::urdf
