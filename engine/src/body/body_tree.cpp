// Joins the links of a draft to a Model.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "base/text.h"
#include "body_draft.h"
#include "urdf/urdf_draft.h"

namespace rehearse::body {
namespace {

/// Devices without a name get that of their type, and devices of one name get numbers: recordings distinguish devices
/// by their names.
void name_devices(std::vector<LinkDraft>& links, urdf::Findings& findings) {
  std::set<std::string> names;
  for (LinkDraft& draft : links) {
    for (Device& device : draft.devices) {
      const std::string written = device.name;
      const std::string base = written.empty() ? std::string(type_name(device)) : written;
      device.name = base;
      for (int i = 2; !names.insert(device.name).second; ++i) device.name = fmt::format("{}_{}", base, i);
      if (device.name == written) continue;
      const std::string before = written.empty() ? fmt::format("a {} has no name", base)
                                                 : fmt::format("a second device has the name {}", in_quotes(written));
      findings.warning(device.line, fmt::format("{}; it gets {}", before, in_quotes(device.name)));
    }
  }
}

/// The links as a draft of the URDF loader, which does the remaining steps.
urdf::Draft urdf_draft_of(BodyDraft& draft, Files& files) {
  urdf::Draft tree;
  urdf::Findings& findings = files.main().findings();
  tree.name = draft.name;
  name_devices(draft.links, findings);
  for (LinkDraft& part : draft.links) {
    const std::string name = part.link.name;
    const bool is_root = name == draft.root_link && part.parent.empty();
    for (Device& device : part.devices) {
      urdf::DeviceDraft& placed = tree.devices.emplace_back();
      placed.device = std::move(device);
      placed.reference = name;
      placed.meaning = urdf::Reference::link;
    }
    if (!is_root) {
      if (part.parent.empty()) {
        findings.error(part.link.line, fmt::format("link {} has no parent", in_quotes(name)),
                       fmt::format("parent: a link; only the root link, {}, has none", in_quotes(draft.root_link)));
        tree.is_complete = false;
      } else {
        tree.joints.push_back({part.link.joint, part.parent, name, std::nullopt});
      }
    }
    tree.links.push_back({std::move(part.link), true, false});
  }
  return tree;
}

/// Joints with a jointId first, in its order, then the remaining joints in the order of links. Of several joints of one
/// id the first counts.
void number_joints(Model& model, urdf::Findings& findings) {
  std::set<int> ids;
  for (const Link& link : model.links) {
    const int id = link.joint.controller_id.value_or(-1);
    if (id >= 0 && !ids.insert(id).second)
      findings.warning(link.line, fmt::format("the jointId {} of link {} appears twice; controllers see the first link",
                                              id, in_quotes(link.name)));
  }
  const int count = static_cast<int>(ids.size());
  if (count > 0 && *ids.rbegin() != count - 1)
    findings.warning(0, fmt::format("the jointIds have gaps: {} ids up to {}; controllers see joints without effect",
                                    count, *ids.rbegin()));
  const auto place = [&model](int link) {
    const int id = model.links[static_cast<std::size_t>(link)].joint.controller_id.value_or(-1);
    return id < 0 ? max_body_links : id;
  };
  std::ranges::sort(model.joints);
  std::ranges::stable_sort(model.joints, [&](int a, int b) { return place(a) < place(b); });
  for (std::size_t id = 0; id < model.joints.size(); ++id)
    model.links[static_cast<std::size_t>(model.joints[id])].joint.id = static_cast<int>(id);
}

}  // namespace

std::optional<Model> join(BodyDraft draft, Files& files) {
  urdf::Findings& findings = files.main().findings();
  const auto root =
      std::ranges::find_if(draft.links, [&draft](const LinkDraft& part) { return part.link.name == draft.root_link; });
  if (root == draft.links.end()) {
    findings.error(0, fmt::format("the root link {} is not a link", in_quotes(draft.root_link)));
    return std::nullopt;
  }
  const Joint root_joint = root->link.joint;
  const CollisionRules rules = draft.rules;
  const std::vector<LoopDraft> loops = std::move(draft.loops);
  std::optional<Model> model = urdf::join(urdf_draft_of(draft, files), findings);
  if (!model) return std::nullopt;
  Joint& joint = model->links.front().joint;
  joint.type = root_joint.type == JointType::free ? JointType::free : JointType::fixed;
  joint.origin = root_joint.origin;
  joint.controller_id = root_joint.controller_id;
  number_joints(*model, findings);
  for (const LoopDraft& loop : loops) {
    LoopJoint& closing = model->loops.emplace_back(loop.joint);
    closing.link = model->find_link(loop.link1);
    closing.other_link = model->find_link(loop.link2);
  }
  apply_collision_rules(rules, *model);
  return model;
}

}  // namespace rehearse::body
