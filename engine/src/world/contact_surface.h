// Contact parameters from the surfaces of two links and the solver's settings. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/world.h>

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

namespace rehearse {

/// A link's surface at a contact.
struct TouchedSurface {
  const Surface& surface;
  Eigen::Vector3d friction_direction;  // in the world; zero: none
  std::string_view material = {};      // empty: none
};

/// The parameters of all contacts of two surfaces in a step.
class ContactTerms {
 public:
  /// Sets the contact's surface parameters, and changes the depth of contact.geom so that ODE applies the wanted
  /// correcting velocity.
  void apply(dContact& contact) const;

 private:
  friend class ContactLaw;

  /// Friction that differs across a direction.
  struct Direction {
    Eigen::Vector3d along;  // of the surface's friction, in the world
    double across;          // coefficient
  };

  void apply_direction(dContact& contact) const;

  dSurfaceParameters surface_{};         // of every contact, whatever its normal and depth
  std::array<Direction, 2> directions_;  // the first that isn't along the normal applies
  std::size_t direction_count_ = 0;
  bool limits_depth_ = false;
  double min_depth_ = 0.0;          // at which contacts rest [m]
  double max_overlap_ = dInfinity;  // beyond it, by the limit of the correcting velocity [m]
  double layer_ = 0.0;              // ODE's surface layer [m]
};

/// Combines two surfaces. A property that one side states applies; if both state it, the smaller value applies, but
/// stiffness and damping act in series. For a property that neither side states, the solver's settings apply. The
/// values of the pair of both materials have precedence over all of these.
class ContactLaw {
 public:
  ContactLaw(const WorldSettings& settings, const std::vector<WorldBody>& bodies);

  /// ODE's limit of the correcting velocity of all contacts [m/s]. ODE has one limit for the whole world: if any
  /// surface states a limit or stiffness, ODE's limit is infinite, and the terms limit each contact.
  double ode_correcting_velocity() const;

  /// True if a belt drives a contact of that depth [m].
  bool drives(double depth) const { return depth <= solver_.belt_depth; }

  /// The parameters of the contacts of the two surfaces in this step.
  ContactTerms between(const TouchedSurface& a, const TouchedSurface& b) const;

 private:
  void set_friction(const TouchedSurface& a, const TouchedSurface& b, ContactTerms& terms) const;
  static void set_rolling(const Surface& a, const Surface& b, ContactTerms& terms);
  void set_spring(const Surface& a, const Surface& b, ContactTerms& terms) const;
  void set_bounce(const TouchedSurface& a, const TouchedSurface& b, ContactTerms& terms) const;

  /// The values of the pair of materials, or null.
  const MaterialPair* pair_of(const TouchedSurface& a, const TouchedSurface& b) const;

  SolverSettings solver_;
  std::vector<MaterialPair> pairs_;
  double time_step_;
  double bounce_speed_;  // slower contacts don't bounce [m/s]
  bool each_has_its_limit_ = false;
};

}  // namespace rehearse
