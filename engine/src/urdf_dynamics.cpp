#include "urdf_draft.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace rehearse::urdf {
namespace {

constexpr double greatest_mass_ratio = 1000.0;

/// Links that fixed joints make one rigid body, named by the one nearest to the root.
struct RigidBody {
  std::vector<std::pair<const Link*, Eigen::Isometry3d>> links;  // each with its pose in the first one's frame
  bool moves = true;
};

std::vector<RigidBody> rigid_bodies(const Model& model) {
  std::vector<RigidBody> bodies;
  std::vector<std::pair<std::size_t, Eigen::Isometry3d>> places;  // by link: its body, and its pose in that
  for (const Link& link : model.links) {
    if (link.parent >= 0 && link.joint.type == JointType::fixed) {
      const auto [body, pose] = places[static_cast<std::size_t>(link.parent)];
      places.emplace_back(body, pose * link.joint.origin);
    } else {
      places.emplace_back(bodies.size(), Eigen::Isometry3d::Identity());
      bodies.emplace_back().moves = link.joint.type != JointType::fixed;
    }
    bodies[places.back().first].links.emplace_back(&link, places.back().second);
  }
  return bodies;
}

/// Sum over the links, about the common centre and along the axes of the first link (parallel axis theorem).
Inertial sum(const RigidBody& body) {
  Inertial total;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  for (const auto& [link, pose] : body.links) {
    total.mass += link->inertial.mass;
    moment += link->inertial.mass * (pose * link->inertial.center);
  }
  if (total.mass > 0.0) total.center = moment / total.mass;
  for (const auto& [link, pose] : body.links) {
    const Eigen::Vector3d arm = pose * link->inertial.center - total.center;
    total.inertia += pose.linear() * link->inertial.inertia * pose.linear().transpose();
    total.inertia += link->inertial.mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  }
  return total;
}

/// Principal moments, ascending.
Eigen::Vector3d principal_moments(const Eigen::Matrix3d& inertia) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

bool is_positive_definite(const Eigen::Matrix3d& inertia) {
  constexpr double rounding = 1e-12;
  const Eigen::Vector3d moments = principal_moments(inertia);
  return inertia.allFinite() && moments.x() > rounding * moments.z();
}

void check_body(const RigidBody& body, const Inertial& total, Findings& findings) {
  const Link& link = *body.links.front().first;
  if (!body.moves) return;
  if (!(total.mass > 0.0)) {
    findings.error(link.line, fmt::format("link {} moves but has no mass", in_quotes(link.name)),
                   "give it or a link fixed to it an <inertial>");
  } else if (!is_positive_definite(total.inertia)) {
    findings.error(link.line,
                   fmt::format("the inertia of moving link {} isn't positive definite", in_quotes(link.name)),
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

void check_mass_ratio(const std::vector<RigidBody>& bodies, const std::vector<Inertial>& totals, Findings& findings) {
  const Link* lightest = nullptr;
  double least = 0.0;
  double most = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].moves || !(totals[i].mass > 0.0)) continue;
    if (lightest == nullptr || totals[i].mass < least) {
      lightest = bodies[i].links.front().first;
      least = totals[i].mass;
    }
    most = std::max(most, totals[i].mass);
  }
  if (lightest == nullptr || most <= greatest_mass_ratio * least) return;
  findings.warning(lightest->line,
                   fmt::format("link {} has {:.3g} kg and another has {:.3g} kg: joints between bodies so "
                               "different give way",
                               in_quotes(lightest->name), least, most));
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
  const std::vector<RigidBody> bodies = rigid_bodies(model);
  std::vector<Inertial> totals;
  for (const RigidBody& body : bodies) {
    totals.push_back(sum(body));
    check_body(body, totals.back(), findings);
  }
  check_mass_ratio(bodies, totals, findings);
  for (const Link& link : model.links) check_triangle(link, findings);
  note_all(
      model, [](const Link& link) { return link.inertial.inertia == Eigen::Matrix3d::Identity(); },
      "an inertia of exactly 1 1 1, which some exporters write for 'unknown'", findings);
  note_all(
      model, [](const Link& link) { return link.collisions.empty() && !link.visuals.empty(); },
      "visible shapes without collision shapes: nothing touches them", findings);
}

}  // namespace rehearse::urdf
