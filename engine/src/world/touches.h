// Touches: the contacts of a step and their forces. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <vector>

#include "friction.h"
#include "ode_math.h"
#include "simulated_body.h"

namespace rehearse {

class Touches {
 public:
  /// One of the two shapes that meet; body and shape must outlive the step.
  struct Party {
    const SimulatedBody& body;
    const BodyShape& shape;
  };

  /// A contact of the parties a and b; the normal of `geom` points into a.
  struct Contact {
    Contact(const dContactGeom& of, const Party& first, const Party& second)
        : geom(of), a(first, of, -1.0), b(second, of, 1.0) {}

    /// Velocity of a's surface relative to b's at the contact [m/s].
    Eigen::Vector3d velocity() const { return a.velocity() - b.velocity(); }
    /// Angular velocity of a relative to b [rad/s].
    Eigen::Vector3d spin() const { return a.angular_velocity() - b.angular_velocity(); }
    /// The contact as a point with friction.
    FrictionPoint point() const { return {patch, vector(geom.pos), vector(geom.normal)}; }
    /// Force on a during ODE's step [N].
    Eigen::Vector3d force() const;
    /// Sets it where ODE doesn't.
    void set_force(const Eigen::Vector3d& force);

    struct Side {
      /// `sign`: of the outward normal relative to that of `geom`.
      Side(const Party& party, const dContactGeom& geom, double sign)
          : body(&party.body), shape(&party.shape), ode(dGeomGetBody(party.shape.geom)) {
        if (ode) arm = vector(geom.pos) - vector(dBodyGetPosition(ode));
        if (has_belt()) run_belt(sign * vector(geom.normal));
      }
      void run_belt(const Eigen::Vector3d& outward);

      const SimulatedBody* body;
      const BodyShape* shape;
      dBodyID ode;                                     // null: the body never moves
      Eigen::Vector3d arm = Eigen::Vector3d::Zero();   // from the centre of mass to the point, before the step [m]
      Eigen::Vector3d belt = Eigen::Vector3d::Zero();  // velocity of its surface relative to it [m/s]

      Eigen::Vector3d velocity() const {
        if (!ode) return belt;
        return vector(dBodyGetLinearVel(ode)) + vector(dBodyGetAngularVel(ode)).cross(arm) + belt;
      }
      Eigen::Vector3d angular_velocity() const {
        return ode ? vector(dBodyGetAngularVel(ode)) : Eigen::Vector3d(Eigen::Vector3d::Zero());
      }
      /// True if forces move the shape.
      bool yields() const { return ode && !dBodyIsKinematic(ode); }
      bool has_belt() const { return shape->belt >= 0; }
    };
    // The members that friction reads after the step are side by side: the solver's data displace them from the cache.
    FrictionPatch* patch = nullptr;  // of both links
    dContactGeom geom;
    dJointFeedback feedback{};  // ODE writes into it
    Side a, b;
  };

  /// Before ODE's step. The contact is valid until the next add().
  Contact& add(const dContactGeom& geom, const Party& a, const Party& b) { return contacts_.emplace_back(geom, a, b); }
  std::vector<Contact>& contacts() { return contacts_; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  /// The contacts of the body's links for which feels() is true, in the order of add(). Call it after ODE's step,
  /// before velocities change. Places are those at the beginning of the step, where the contacts were found.
  std::vector<Touch> of(const SimulatedBody& body) const;
  void clear() { contacts_.clear(); }

 private:
  std::vector<Contact> contacts_;
};

}  // namespace rehearse
