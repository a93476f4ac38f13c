#include "rigid_groups.h"
#include "urdf_draft.h"

#include <fmt/format.h>

#include <algorithm>

namespace rehearse::urdf {
namespace {

constexpr double greatest_mass_ratio = 1000.0;

/// A rigid group that moves, or may.
struct Group {
  const Link& first;
  const Inertial& inertial;
};

std::vector<Group> moving_groups(const Model& model, const RigidGroups& groups) {
  std::vector<Group> moving;
  for (std::size_t i = 0; i < groups.first_links.size(); ++i) {
    const Link& first = model.links[static_cast<std::size_t>(groups.first_links[i])];
    if (first.joint.type != JointType::fixed) moving.push_back({first, groups.inertials[i]});
  }
  return moving;
}

void check_group(const Group& group, Findings& findings) {
  if (!(group.inertial.mass > 0.0)) {
    findings.error(group.first.line, fmt::format("link {} moves but has no mass", in_quotes(group.first.name)),
                   "give it or a link fixed to it an <inertial>");
  } else if (!is_positive_definite(group.inertial.inertia)) {
    findings.error(group.first.line,
                   fmt::format("the inertia of moving link {} isn't positive definite", in_quotes(group.first.name)),
                   "its three principal moments must be above 0");
  }
}

/// No real body has one principal moment above the sum of the others.
void check_triangle(const Link& link, Findings& findings) {
  constexpr double slack = 1e-6;
  const Eigen::Vector3d moments = principal_moments(link.inertial.inertia);
  if (link.inertial.mass <= 0.0 || moments.z() <= (moments.x() + moments.y()) * (1.0 + slack)) return;
  findings.warning(link.line,
                   fmt::format("no body has the inertia of link {}: one principal moment is above the sum of "
                               "the other two",
                               in_quotes(link.name)));
}

void check_mass_ratio(const std::vector<Group>& groups, Findings& findings) {
  const Group* lightest = nullptr;
  double most = 0.0;
  for (const Group& group : groups) {
    if (!(group.inertial.mass > 0.0)) continue;
    if (lightest == nullptr || group.inertial.mass < lightest->inertial.mass) lightest = &group;
    most = std::max(most, group.inertial.mass);
  }
  if (lightest == nullptr || most <= greatest_mass_ratio * lightest->inertial.mass) return;
  findings.warning(lightest->first.line,
                   fmt::format("link {} has {:.3g} kg and another has {:.3g} kg: joints between bodies so "
                               "different give way",
                               in_quotes(lightest->first.name), lightest->inertial.mass, most));
}

/// One note for all links of a kind, at the first of them.
template <class Predicate>
void note_all(const Model& model, const Predicate& is_of_kind, const char* text, Findings& findings) {
  const auto count = std::count_if(model.links.begin(), model.links.end(), is_of_kind);
  if (count == 0) return;
  const Link& first = *std::find_if(model.links.begin(), model.links.end(), is_of_kind);
  findings.note(first.line,
                fmt::format("{} ({} of {} links, first {})", text, count, model.links.size(), in_quotes(first.name)));
}

}  // namespace

void check_dynamics(const Model& model, Findings& findings) {
  const RigidGroups groups = group_links(model);
  const std::vector<Group> moving = moving_groups(model, groups);
  for (const Group& group : moving) check_group(group, findings);
  check_mass_ratio(moving, findings);
  for (const Link& link : model.links) check_triangle(link, findings);
  note_all(
      model, [](const Link& link) { return link.inertial.inertia == Eigen::Matrix3d::Identity(); },
      "an inertia of exactly 1 1 1, which some exporters write for 'unknown'", findings);
  note_all(
      model, [](const Link& link) { return link.collisions.empty() && !link.visuals.empty(); },
      "visible shapes without collision shapes: nothing touches them", findings);
}

}  // namespace rehearse::urdf
