// Contact parameters from the surfaces of two links and the solver's settings. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/world.h>

#include <string_view>
#include <vector>

namespace rehearse {

/// A link's surface at a contact.
struct TouchedSurface {
  const Surface& surface;
  Eigen::Vector3d friction_direction;  // in the world; zero: none
  std::string_view material = {};      // empty: none
};

/// Combines two surfaces. A property that one side states applies; if both state it, the smaller value applies, but
/// stiffness and damping act in series. For a property that neither side states, the solver's settings apply. What the
/// pair of both materials states goes before all of that.
class ContactLaw {
 public:
  ContactLaw(const WorldSettings& settings, const std::vector<WorldBody>& bodies);

  /// ODE's limit of the correcting velocity of all contacts [m/s]. ODE has one limit for the whole world: if any
  /// surface states a limit or stiffness, ODE's limit is infinite, and apply() limits each contact.
  double ode_correcting_velocity() const;

  /// True if a belt drives a contact of that depth [m].
  bool drives(double depth) const { return depth <= solver_.belt_depth; }

  /// Sets the contact's surface parameters, and changes the depth of contact.geom so that ODE applies the wanted
  /// correcting velocity.
  void apply(const TouchedSurface& a, const TouchedSurface& b, dContact& contact) const;

 private:
  void apply_friction(const TouchedSurface& a, const TouchedSurface& b, dContact& contact) const;
  void apply_rolling(const Surface& a, const Surface& b, dContact& contact) const;
  void apply_spring(const Surface& a, const Surface& b, dContact& contact) const;
  void apply_bounce(const TouchedSurface& a, const TouchedSurface& b, dContact& contact) const;

  /// What is stated for the pair of materials, or null.
  const MaterialPair* pair_of(const TouchedSurface& a, const TouchedSurface& b) const;

  SolverSettings solver_;
  std::vector<MaterialPair> pairs_;
  double time_step_;
  double bounce_speed_;  // slower contacts don't bounce [m/s]
  bool each_has_its_limit_ = false;
};

}  // namespace rehearse
