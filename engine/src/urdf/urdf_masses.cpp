#include "model/rigid_groups.h"
#include "model/shape_bounds.h"
#include "urdf_draft.h"

#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace rehearse::urdf {
namespace {

constexpr double water = 1000.0;  // [kg/m³]

/// The box around the collision shapes of all links of a group, in its frame; around the visible shapes if there are no
/// collision shapes. Meshes are left out: a replay has no meshes and must compute the same inertia.
Eigen::AlignedBox3d box_around(const Model& model, const RigidGroups& groups, int group) {
  Eigen::AlignedBox3d touched, seen;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (groups.links[i].group != group) continue;
    const Link& link = model.links[i];
    const Eigen::Isometry3d& pose = groups.links[i].in_group;
    const auto extend = [&pose](Eigen::AlignedBox3d& box, const std::vector<Shape>& shapes) {
      for (const Shape& shape : shapes)
        if (!std::holds_alternative<Mesh>(shape.geometry)) box.extend(bounds(shape.geometry, pose * shape.pose));
    };
    extend(touched, link.collisions);
    extend(seen, link.visuals);
  }
  return touched.isEmpty() ? seen : touched;
}

Inertial solid_box(const Eigen::AlignedBox3d& box, double mass) {
  Inertial inertial = solid_inertial(Box{box.sizes()}, mass);
  inertial.center = box.center();
  return inertial;
}

/// Gives the group's first link the default mass: as the box around the group's shapes or, if the box is empty or a
/// line, as a ball of water.
void give_mass(Model& model, const RigidGroups& groups, int group, double mass, Findings& findings) {
  Link& link = model.links[static_cast<std::size_t>(groups.first_links[static_cast<std::size_t>(group)])];
  const Eigen::AlignedBox3d box = box_around(model, groups, group);
  std::string form;
  if (!box.isEmpty()) link.inertial = solid_box(box, mass);
  if (!box.isEmpty() && is_positive_definite(link.inertial.inertia)) {
    const Eigen::Vector3d size = box.sizes();
    form = fmt::format("the box around its shapes, {:.3g} x {:.3g} x {:.3g} m", size.x(), size.y(), size.z());
  } else {
    const double radius = std::cbrt(mass / water * 3.0 / (4.0 * std::numbers::pi));
    link.inertial = solid_inertial(Sphere{radius}, mass);
    form = fmt::format("a ball of {:.3g} m radius about its origin", radius);
  }
  findings.repair(link.line,
                  fmt::format("link {} moves but has no mass; it gets the default of {:.6g} kg, spread over {}",
                              in_quotes(link.name), mass, form));
}

}  // namespace

void complete_masses(Model& model, const UrdfOptions& options, Findings& findings) {
  if (options.kinematic) return;
  const RigidGroups groups = group_links(model);
  for (std::size_t i = 0; i < groups.first_links.size(); ++i) {
    if (groups.inertials[i].mass > 0.0) continue;
    Link& first = model.links[static_cast<std::size_t>(groups.first_links[i])];
    if (first.joint.type == JointType::fixed || (i == 0 && options.fixed_root)) continue;
    if (i == 0) {
      findings.repair(first.line,
                      fmt::format("root link {} has no mass; it is fixed to the world", in_quotes(first.name)),
                      "to set it free, give it or a link fixed to it an <inertial>");
      first.joint.type = JointType::fixed;
    } else if (options.default_mass) {
      give_mass(model, groups, static_cast<int>(i), *options.default_mass, findings);
    } else {
      findings.error(first.line, fmt::format("link {} moves but has no mass", in_quotes(first.name)),
                     "give it or a link fixed to it an <inertial>, or state a default mass when loading it");
    }
  }
}

}  // namespace rehearse::urdf
