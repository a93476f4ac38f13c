// What contacts are like where links have surfaces of their own. Private to the world library.
#pragma once

#include <ode/ode.h>
#include <rehearse/world.h>

#include <vector>

namespace rehearse {

/// A link's surface at a contact.
struct TouchedSurface {
  const Surface& surface;
  Eigen::Vector3d friction_direction;  // in the world; zero: none
};

/// What one side states holds; of what both state, the smaller, but stiffness and damping act in series. What neither
/// states is as the solver's settings have it.
class ContactLaw {
 public:
  ContactLaw(const WorldSettings& settings, const std::vector<WorldBody>& bodies);

  /// What ODE limits the correcting velocity of all contacts to [m/s]. ODE has one limit for the whole world: if any
  /// surface has one of its own, or springs, it is infinite, and apply() limits each contact.
  double ode_correcting_velocity() const;

  /// A contact's surface, and as the depth of contact.geom what makes ODE push apart as it should.
  void apply(const TouchedSurface& a, const TouchedSurface& b, dContact& contact) const;

 private:
  void apply_friction(const TouchedSurface& a, const TouchedSurface& b, dContact& contact) const;
  void apply_spring(const Surface& a, const Surface& b, dContact& contact) const;
  void apply_bounce(const Surface& a, const Surface& b, dContact& contact) const;

  SolverSettings solver_;
  double time_step_;
  double bounce_speed_;  // what comes slower doesn't bounce [m/s]
  bool each_has_its_limit_ = false;
};

}  // namespace rehearse
