// Where a convex hull touches another shape. Private to the world library.
//
// ODE 0.16.2 gives one point for a pair with a convex hull, another one in each step: what rests on it rocks at
// 0.05 rad/s. Here such a pair has the points of the whole touching face, as boxes have in ODE.
//
// The direction in which two shapes overlap least is found by the separating axis theorem (S. Gottschalk, Separating
// axis theorem, TR96-024; edges as D. Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013); the
// touching faces are clipped against each other (Sutherland and Hodgman). All is in the frame of the first hull.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "polytope.h"

namespace rehearse {

/// A point where a hull touches something.
struct TouchPoint {
  Eigen::Vector3d position;  // half way between both surfaces [m]
  Eigen::Vector3d normal;    // out of the hull into the other one, unit length
  double depth;              // how far they overlap, at least 0 [m]
};

/// No more points than that stay of a touching face, spread over it.
inline constexpr std::size_t max_touches = 8;

/// What stands about its own z axis: a cylinder, and a capsule without its caps.
struct Round {
  Eigen::Vector3d center;
  Eigen::Matrix3d axes;  // columns: its x, y, z
  double radius;         // [m]
  double half_length;    // [m]

  Eigen::Vector3d axis() const { return axes.col(2); }
};

std::vector<TouchPoint> touch_hull(const Polytope& hull, const PlacedPolytope& other);
std::vector<TouchPoint> touch_sphere(const Polytope& hull, const Eigen::Vector3d& center, double radius);
std::vector<TouchPoint> touch_capsule(const Polytope& hull, const Round& capsule);
std::vector<TouchPoint> touch_cylinder(const Polytope& hull, const Round& cylinder);

}  // namespace rehearse
