// Contact points of a convex hull and another shape. Private to the world library.
//
// ODE 0.16.2 gives one point for a pair with a convex hull, a different one in each step: a body that rests on it rocks
// at 0.05 rad/s. This file computes the points of the whole touching face, as ODE does for boxes.
//
// The direction in which two shapes overlap least is found by the separating axis theorem (S. Gottschalk, Separating
// axis theorem, TR96-024; edges as D. Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013); the
// touching faces are clipped against each other (Sutherland and Hodgman). All is in the frame of the first hull.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "polytope.h"

namespace rehearse {

/// A point where a hull touches another shape.
struct TouchPoint {
  Eigen::Vector3d position;  // half way between both surfaces [m]
  Eigen::Vector3d normal;    // out of the hull into the other shape, unit length
  double depth;              // how far the shapes overlap, at least 0 [m]
};

/// The largest number of points of a touching face; they are spread over the face.
inline constexpr std::size_t max_touches = 8;

/// A shape that is round about its own z axis: a cylinder, or a capsule without its caps.
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
