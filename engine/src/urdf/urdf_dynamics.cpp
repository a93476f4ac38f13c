#include "model/rigid_groups.h"
#include "model/shape_bounds.h"
#include "urdf_draft.h"

#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rehearse::urdf {
namespace {

constexpr double greatest_mass_ratio = 1000.0;
constexpr double greatest_gyration = 10.0;      // [m]
constexpr double smallest_gyration = 1e-4;      // [m]
constexpr double greatest_joint_offset = 10.0;  // [m]

/// A rigid group that moves, or may move, and has mass.
struct Group {
  const Link& link;  // the heaviest link of the group; messages name it
  const Inertial& inertial;
};

const Link& heaviest(const Model& model, const RigidGroups& groups, std::size_t group) {
  const Link* found = &model.links[static_cast<std::size_t>(groups.first_links[group])];
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (groups.links[i].group != static_cast<int>(group)) continue;
    if (model.links[i].inertial.mass > found->inertial.mass) found = &model.links[i];
  }
  return *found;
}

std::vector<Group> moving_groups(const Model& model, const RigidGroups& groups, const UrdfOptions& options) {
  std::vector<Group> moving;
  for (std::size_t i = 0; i < groups.first_links.size(); ++i) {
    const Link& first = model.links[static_cast<std::size_t>(groups.first_links[i])];
    const bool is_fixed = first.joint.type == JointType::fixed || (i == 0 && options.fixed_root);
    if (!is_fixed && groups.inertials[i].mass > 0.0)
      moving.push_back({heaviest(model, groups, i), groups.inertials[i]});
  }
  return moving;
}

/// Radius of gyration: the distance from the centre at which all mass would have the same inertia [m].
double gyration(const Inertial& inertial) {
  return std::sqrt(std::max(0.0, principal_moments(inertial.inertia).z()) / inertial.mass);
}

void check_inertia(const Group& group, Findings& findings) {
  const auto& [link, inertial] = group;
  if (inertial.inertia.isZero(0.0)) {
    findings.error(link.line, fmt::format("moving link {} has mass but no inertia", in_quotes(link.name)),
                   "a solid box of a x b x c has ixx = m (b² + c²) / 12, and so on");
  } else if (!is_positive_definite(inertial.inertia)) {
    findings.error(link.line,
                   fmt::format("the inertia of moving link {} isn't positive definite", in_quotes(link.name)),
                   "its three principal moments must be above 0");
  } else if (gyration(inertial) < smallest_gyration) {
    findings.warning(link.line, fmt::format("the inertia of moving link {} is that of {:.3g} kg within {:.1g} m",
                                            in_quotes(link.name), inertial.mass, gyration(inertial)));
  }
}

/// No real body has a principal moment above the sum of the two others.
void check_triangle(const Link& link, Findings& findings) {
  constexpr double slack = 1e-6;
  const Eigen::Vector3d moments = principal_moments(link.inertial.inertia);
  if (moments.z() <= (moments.x() + moments.y()) * (1.0 + slack)) return;
  findings.warning(link.line,
                   fmt::format("no body has the inertia of link {}: one principal moment is above the sum of "
                               "the other two",
                               in_quotes(link.name)));
}

void check_gyration(const Link& link, Findings& findings) {
  if (gyration(link.inertial) <= greatest_gyration) return;
  findings.warning(link.line,
                   fmt::format("link {} has the inertia of a body many metres wide: its radius of gyration "
                               "is {:.3g} m",
                               in_quotes(link.name), gyration(link.inertial)),
                   "inertia is in kg·m², lengths are in m");
}

/// Warns if the centre of mass is outside twice the box around the shapes. Many correct models give joints of a wrist
/// or ankle one rough shape and a centre beside it: a distance below half a metre is accepted.
void check_center(const Link& link, Findings& findings) {
  Eigen::AlignedBox3d box;
  for (const auto* shapes : {&link.visuals, &link.collisions}) {
    for (const Shape& shape : *shapes) box.extend(bounds(shape.geometry, shape.pose));
  }
  if (box.isEmpty()) return;
  const Eigen::Vector3d reach = box.sizes().cwiseMax(0.5);  // from the box's middle [m]
  const Eigen::Vector3d off = link.inertial.center - box.center();
  if ((off.cwiseAbs().array() <= reach.array()).all()) return;
  findings.warning(link.line,
                   fmt::format("the centre of mass of link {} is far outside its shapes: {:.3g} m from "
                               "their middle",
                               in_quotes(link.name), off.norm()),
                   "lengths are in m");
}

/// Warns of a link far from its parent. A robot may be at any distance from its world.
void check_distance(const Model& model, const Link& link, Findings& findings) {
  if (link.parent < 0 || model.links[static_cast<std::size_t>(link.parent)].name == "world") return;
  const double distance = link.joint.origin.translation().norm();
  if (distance <= greatest_joint_offset) return;
  findings.warning(
      link.joint.line,
      fmt::format("joint {} is {:.4g} m away from the origin of its parent link", in_quotes(link.joint.name), distance),
      "lengths are in m");
}

void check_mass_ratio(const std::vector<Group>& groups, Findings& findings) {
  const Group* lightest = nullptr;
  double most = 0.0;
  for (const Group& group : groups) {
    if (lightest == nullptr || group.inertial.mass < lightest->inertial.mass) lightest = &group;
    most = std::max(most, group.inertial.mass);
  }
  if (lightest == nullptr || most <= greatest_mass_ratio * lightest->inertial.mass) return;
  findings.warning(lightest->link.line,
                   fmt::format("link {} has {:.3g} kg and another has {:.3g} kg: joints between bodies so "
                               "different give way",
                               in_quotes(lightest->link.name), lightest->inertial.mass, most));
}

/// Adds one note for all links of a kind, at the first of them.
template <class Predicate>
void note_all(const Model& model, const Predicate& is_of_kind, const char* text, Findings& findings) {
  const auto count = std::ranges::count_if(model.links, is_of_kind);
  if (count == 0) return;
  const Link& first = *std::ranges::find_if(model.links, is_of_kind);
  findings.note(first.line,
                fmt::format("{} ({} of {} links, first {})", text, count, model.links.size(), in_quotes(first.name)));
}

}  // namespace

void check_dynamics(const Model& model, const UrdfOptions& options, Findings& findings) {
  const RigidGroups groups = group_links(model);
  const std::vector<Group> moving = moving_groups(model, groups, options);
  if (!options.kinematic) {
    for (const Group& group : moving) check_inertia(group, findings);
    check_mass_ratio(moving, findings);
  }
  for (const Link& link : model.links) {
    check_distance(model, link, findings);
    if (!(link.inertial.mass > 0.0)) continue;
    check_triangle(link, findings);
    check_gyration(link, findings);
    check_center(link, findings);
  }
  note_all(
      model, [](const Link& link) { return link.inertial.inertia == Eigen::Matrix3d::Identity(); },
      "an inertia of exactly 1 1 1, which some exporters write for 'unknown'", findings);
  note_all(
      model, [](const Link& link) { return link.collisions.empty() && !link.visuals.empty(); },
      "visible shapes without collision shapes: nothing touches them", findings);
}

}  // namespace rehearse::urdf
