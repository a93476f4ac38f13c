// Touches: the contacts of a step whose forces are measured. Private to the world library.
#pragma once

#include <ode/ode.h>

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "simulated_body.h"

namespace rehearse {

class Touches {
 public:
  /// One of the two shapes that meet; body and shape must outlive the step.
  struct Party {
    const SimulatedBody& body;
    const BodyShape& shape;
  };

  /// Before ODE's step: `joint` has just been attached to the parties' bodies, `a` first; the normal of `geom` points
  /// into a.
  void keep(dJointID joint, const dContactGeom& geom, const Party& a, const Party& b);
  /// The contacts of the body's links for which feels() is true, in the order of keep(). Call it after ODE's step,
  /// before velocities change. Places are those at the beginning of the step, where the contacts were found.
  std::vector<Touch> of(const SimulatedBody& body) const;
  void clear() { kept_.clear(); }

 private:
  struct Side {
    const SimulatedBody* body;
    const BodyShape* shape;
    dBodyID ode;           // null: the body never moves
    Eigen::Vector3d arm;   // from the centre of mass to the point, at the beginning of the step [m]
    Eigen::Vector3d belt;  // velocity of its surface relative to it [m/s]

    Eigen::Vector3d velocity() const;
  };
  struct Kept {
    dContactGeom geom;
    Side a, b;
    dJointFeedback feedback;
  };
  static Side side_of(const Party& party, const Eigen::Vector3d& point, const Eigen::Vector3d& outward);

  std::deque<Kept> kept_;  // ODE writes into them: they must not move
};

}  // namespace rehearse
