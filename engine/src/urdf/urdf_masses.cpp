#include "model/rigid_groups.h"
#include "model/shape_bounds.h"
#include "urdf_draft.h"

#include <rehearse/urdf.h>

#include <fmt/format.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <numbers>

namespace rehearse::urdf {
namespace {

constexpr double water = 1000.0;  // [kg/m³]

/// The box around shapes, in the frame with that pose of their link. Meshes are left out: a replay has no meshes and
/// must compute the same inertia.
Eigen::AlignedBox3d box_around(const std::vector<Shape>& shapes,
                               const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity()) {
  Eigen::AlignedBox3d box;
  for (const Shape& shape : shapes)
    if (!std::holds_alternative<Mesh>(shape.geometry)) box.extend(bounds(shape.geometry, pose * shape.pose));
  return box;
}

/// The box around the collision shapes of all links of a group, in its frame; around the visible shapes if there are no
/// collision shapes.
Eigen::AlignedBox3d box_around(const Model& model, const RigidGroups& groups, int group) {
  Eigen::AlignedBox3d touched, seen;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    if (groups.links[i].group != group) continue;
    touched.extend(box_around(model.links[i].collisions, groups.links[i].in_group));
    seen.extend(box_around(model.links[i].visuals, groups.links[i].in_group));
  }
  return touched.isEmpty() ? seen : touched;
}

/// An inertial, and the body of even density that it was computed of, for messages.
struct Spread {
  Inertial inertial;
  std::string form;
};

/// A mass spread over a box or, if the box is empty or a line, over a ball of water about the origin.
Spread spread_over(const Eigen::AlignedBox3d& box, double mass) {
  Spread spread;
  if (!box.isEmpty()) {
    spread.inertial = solid_inertial(Box{box.sizes()}, mass);
    spread.inertial.center = box.center();
  }
  if (is_positive_definite(spread.inertial.inertia)) {
    const Eigen::Vector3d size = box.sizes();
    spread.form = fmt::format("the box around its shapes, {:.3g} x {:.3g} x {:.3g} m", size.x(), size.y(), size.z());
  } else {
    const double radius = std::cbrt(mass / water * 3.0 / (4.0 * std::numbers::pi));
    spread.inertial = solid_inertial(Sphere{radius}, mass);
    spread.form = fmt::format("a ball of {:.3g} m radius about its origin", radius);
  }
  return spread;
}

/// Gives the group's first link the default mass, spread over the group's shapes.
void give_mass(Model& model, const RigidGroups& groups, int group, double mass, Findings& findings) {
  Link& link = model.links[static_cast<std::size_t>(groups.first_links[static_cast<std::size_t>(group)])];
  const Spread spread = spread_over(box_around(model, groups, group), mass);
  link.inertial = spread.inertial;
  findings.repair(link.line,
                  fmt::format("link {} moves but has no mass; it gets the default of {:.6g} kg, spread over {}",
                              in_quotes(link.name), mass, spread.form));
}

/// The link's mass spread over its shapes, about its centre of mass: over one solid shape as it is, over several as
/// over the box around them.
Spread spread_over_shapes(const Link& link) {
  const std::vector<Shape>& shapes = link.collisions.empty() ? link.visuals : link.collisions;
  const bool is_single = shapes.size() == 1 && !std::holds_alternative<Mesh>(shapes.front().geometry);
  if (!is_single) return spread_over(box_around(shapes), link.inertial.mass);
  const Inertial solid = solid_inertial(shapes.front().geometry, link.inertial.mass);
  return {moved(solid, shapes.front().pose), "its shape"};
}

/// The nearest symmetric matrix, in the Frobenius norm, whose principal moments are at least `least` (N. J. Higham,
/// Computing a nearest symmetric positive semidefinite matrix, 1988, theorem 2.1).
Eigen::Matrix3d nearest_with_moments_from(double least, const Eigen::Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  const Eigen::Matrix3d nearest =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(least).asDiagonal() * solver.eigenvectors().transpose();
  return (nearest + nearest.transpose()) / 2.0;  // symmetric to the last bit
}

/// True if the inertia is that of a body smaller than any real one: rounding errors of the program that wrote the file.
bool is_rounding(const Inertial& inertial) {
  constexpr double smallest_gyration = 1e-6;  // [m]
  return principal_moments(inertial.inertia).z() < inertial.mass * smallest_gyration * smallest_gyration;
}

/// Repairs the inertia of a link with mass that has none, or one that isn't positive definite. Rounding errors count as
/// none.
void repair_inertia(Link& link, Findings& findings) {
  constexpr double least_share = 1e-3;  // of the largest moment, as of a rod 1 m long and 26 mm thick
  Eigen::Matrix3d& inertia = link.inertial.inertia;
  if (is_rounding(link.inertial)) {
    const Spread spread = spread_over_shapes(link);
    const char* what = inertia.isZero(0.0) ? "has mass but no inertia" : "has an inertia of rounding errors only";
    inertia = spread.inertial.inertia;
    findings.repair(link.line,
                    fmt::format("moving link {} {}; it gets the inertia of {:.6g} kg spread over {}",
                                in_quotes(link.name), what, link.inertial.mass, spread.form),
                    "a solid box of a x b x c has ixx = m (b² + c²) / 12, and so on");
  } else if (!is_positive_definite(inertia)) {
    const Eigen::Vector3d before = principal_moments(inertia);
    inertia = nearest_with_moments_from(least_share * before.z(), inertia);
    const Eigen::Vector3d after = principal_moments(inertia);
    findings.repair(
        link.line,
        fmt::format("the inertia of moving link {} isn't positive definite; it gets the nearest that is, "
                    "with the principal moments {:.3g}, {:.3g} and {:.3g} kg·m² instead of {:.3g}, {:.3g} and "
                    "{:.3g}",
                    in_quotes(link.name), after.x(), after.y(), after.z(), before.x(), before.y(), before.z()),
        "its three principal moments must be above 0");
  }
}

}  // namespace

void complete_masses(Model& model, const UrdfOptions& options, Findings& findings, const MassHints& hints) {
  if (options.kinematic) return;
  const RigidGroups groups = group_links(model);
  for (std::size_t i = 0; i < groups.first_links.size(); ++i) {
    if (groups.inertials[i].mass > 0.0) continue;
    Link& first = model.links[static_cast<std::size_t>(groups.first_links[i])];
    if (first.joint.type == JointType::fixed || (i == 0 && options.fixed_root)) continue;
    if (i == 0) {
      findings.repair(first.line,
                      fmt::format("root link {} has no mass; it is fixed to the world", in_quotes(first.name)),
                      "to set it free, " + hints.of(first.name));
      first.joint.type = JointType::fixed;
    } else if (options.default_mass) {
      give_mass(model, groups, static_cast<int>(i), *options.default_mass, findings);
    } else {
      findings.error(first.line, fmt::format("link {} moves but has no mass", in_quotes(first.name)),
                     hints.of(first.name) + ", or state a default mass when loading it");
    }
  }
}

void repair_inertias(Model& model, const UrdfOptions& options, Findings& findings) {
  if (options.kinematic) return;
  const RigidGroups groups = group_links(model);
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const auto group = static_cast<std::size_t>(groups.links[i].group);
    const Link& first = model.links[static_cast<std::size_t>(groups.first_links[group])];
    const bool is_fixed = first.joint.type == JointType::fixed || (group == 0 && options.fixed_root);
    const Inertial& whole = groups.inertials[group];
    const bool is_sound = is_positive_definite(whole.inertia) && !is_rounding(whole);
    if (!is_fixed && !is_sound && model.links[i].inertial.mass > 0.0) repair_inertia(model.links[i], findings);
  }
}

}  // namespace rehearse::urdf
