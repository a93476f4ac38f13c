#include "contact_surface.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "ode_math.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

std::optional<double> smaller(const std::optional<double>& a, const std::optional<double>& b) {
  if (a && b) return std::min(*a, *b);
  return a ? a : b;
}

/// Combines two springs, or two dampers, in series; a side without a value is rigid.
std::optional<double> in_series(const std::optional<double>& a, const std::optional<double>& b) {
  if (a && b) return *a + *b > 0.0 ? *a * *b / (*a + *b) : 0.0;
  return a ? a : b;
}

bool limits_velocity(const Link& link) { return link.surface.stiffness || link.surface.max_velocity; }

}  // namespace

ContactLaw::ContactLaw(const WorldSettings& settings, const std::vector<WorldBody>& bodies)
    : solver_(settings.solver),
      pairs_(settings.pairs),
      time_step_(settings.time_step),
      bounce_speed_(2.0 * settings.gravity.norm() * settings.time_step) {
  for (const WorldBody& body : bodies) {
    const std::vector<Link>& links = body.model->links;
    each_has_its_limit_ |= std::ranges::any_of(links, limits_velocity);
  }
}

double ContactLaw::ode_correcting_velocity() const {
  return each_has_its_limit_ ? dInfinity : solver_.max_correcting_velocity;
}

ContactTerms ContactLaw::between(const TouchedSurface& a, const TouchedSurface& b) const {
  ContactTerms terms;
  terms.surface_.mode = dContactApprox1;
  set_friction(a, b, terms);
  set_rolling(a.surface, b.surface, terms);
  set_spring(a.surface, b.surface, terms);
  set_bounce(a, b, terms);
  return terms;
}

const MaterialPair* ContactLaw::pair_of(const TouchedSurface& a, const TouchedSurface& b) const {
  if (pairs_.empty()) return nullptr;
  const auto materials = std::minmax(a.material, b.material);  // clang 14 captures no structured bindings
  const auto found = std::ranges::find_if(pairs_, [&](const MaterialPair& pair) {
    return pair.materials[0] == materials.first && pair.materials[1] == materials.second;
  });
  return found == pairs_.end() ? nullptr : &*found;
}

void ContactLaw::set_friction(const TouchedSurface& a, const TouchedSurface& b, ContactTerms& terms) const {
  if (const MaterialPair* pair = pair_of(a, b); pair != nullptr && pair->friction) {
    terms.surface_.mu = *pair->friction;
    return;
  }
  terms.surface_.mu = smaller(a.surface.friction, b.surface.friction).value_or(solver_.friction);
  for (const auto& [directed, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    const std::optional<double>& second = directed->surface.second_friction;
    if (!second) continue;
    terms.directions_[terms.direction_count_++] = {directed->friction_direction,
                                                   smaller(second, other->surface.friction).value()};
  }
}

void ContactLaw::set_rolling(const Surface& a, const Surface& b, ContactTerms& terms) {
  const std::optional<double> rolling = smaller(a.rolling_friction, b.rolling_friction);
  const std::optional<double> torsional = smaller(a.torsional_friction, b.torsional_friction);
  if (rolling.value_or(0.0) == 0.0 && torsional.value_or(0.0) == 0.0) return;
  // ODE 0.16.2 counts the rows of coefficients that are zero, but leaves them unset
  constexpr double none = std::numeric_limits<double>::min();
  terms.surface_.mode |= dContactRolling | dContactMu2;
  terms.surface_.mu2 = terms.surface_.mu;
  terms.surface_.rho = terms.surface_.rho2 = std::max(none, rolling.value_or(0.0));
  terms.surface_.rhoN = std::max(none, torsional.value_or(0.0));
}

// A spring of kp [N/m] and a damper of kd [N·s/m] are ERP = dt kp / (dt kp + kd), CFM = 1 / (dt kp + kd): manual of
// ODE, 3.8.2. ODE separates two shapes with erp / dt * (depth - surface layer), limited by the world's limit.
void ContactLaw::set_spring(const Surface& a, const Surface& b, ContactTerms& terms) const {
  double erp = solver_.erp;
  const std::optional<double> stiffness = in_series(a.stiffness, b.stiffness);
  if (stiffness) {
    const double step_stiffness = time_step_ * *stiffness;
    const double sum = step_stiffness + in_series(a.damping, b.damping).value_or(0.0);
    erp = step_stiffness / sum;
    terms.surface_.mode |= dContactSoftERP | dContactSoftCFM;
    terms.surface_.soft_erp = erp;
    terms.surface_.soft_cfm = 1.0 / sum;
  }
  const std::optional<double> min_depth = smaller(a.min_depth, b.min_depth);
  if (!each_has_its_limit_ && !min_depth) return;
  terms.limits_depth_ = true;
  terms.min_depth_ = min_depth.value_or(solver_.surface_layer);
  terms.layer_ = solver_.surface_layer;
  const std::optional<double> stated = smaller(a.max_velocity, b.max_velocity);
  const double limit = stated.value_or(stiffness ? dInfinity : solver_.max_correcting_velocity);
  if (each_has_its_limit_ && erp > 0.0) terms.max_overlap_ = limit * time_step_ / erp;
}

void ContactLaw::set_bounce(const TouchedSurface& a, const TouchedSurface& b, ContactTerms& terms) const {
  const MaterialPair* pair = pair_of(a, b);
  const bool is_stated = pair != nullptr && pair->restitution;
  const std::optional<double> restitution =
      is_stated ? pair->restitution : smaller(a.surface.restitution, b.surface.restitution);
  if (!restitution || *restitution <= 0.0) return;
  terms.surface_.mode |= dContactBounce;
  terms.surface_.bounce = *restitution;
  terms.surface_.bounce_vel = bounce_speed_;
}

void ContactTerms::apply(dContact& contact) const {
  contact.surface = surface_;
  apply_direction(contact);
  if (limits_depth_)
    contact.geom.depth = std::min(std::max(0.0, contact.geom.depth - min_depth_), max_overlap_) + layer_;
}

void ContactTerms::apply_direction(dContact& contact) const {
  const Vector3d normal = vector(contact.geom.normal);
  for (std::size_t i = 0; i < direction_count_; ++i) {
    const Vector3d along = directions_[i].along - directions_[i].along.dot(normal) * normal;
    constexpr double least_sine = 1e-3;
    if (along.norm() < least_sine) continue;
    const Vector3d direction = along.normalized();
    std::copy(direction.data(), direction.data() + 3, contact.fdir1);
    contact.surface.mu2 = directions_[i].across;
    if (contact.surface.mu2 == contact.surface.mu) return;  // equal in all directions
    contact.surface.mode |= dContactFDir1 | dContactMu2;
    return;
  }
}

}  // namespace rehearse
