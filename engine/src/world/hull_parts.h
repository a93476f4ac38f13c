// Geometric functions for the contacts of hulls. Private to the world library.
#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "hull_contacts.h"
#include "polytope.h"

namespace rehearse {

using Points = std::vector<Eigen::Vector3d>;

/// A direction out of the hull, and the distance of the other shape along it: negative if they overlap [m].
struct Axis {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double separation = -std::numeric_limits<double>::infinity();
};

/// Index of the vertex that is farthest along a direction, the first of equals.
int farthest_along(const Points& vertices, const Eigen::Vector3d& direction);

Eigen::Vector3d nearest_on_segment(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                   const Eigen::Vector3d& point);

/// The points of two segments that are nearest to each other.
std::pair<Eigen::Vector3d, Eigen::Vector3d> nearest_of_segments(const Eigen::Vector3d& from_a,
                                                                const Eigen::Vector3d& to_a,
                                                                const Eigen::Vector3d& from_b,
                                                                const Eigen::Vector3d& to_b);

/// The point of a hull's face that is nearest to `point`.
Eigen::Vector3d nearest_on_face(const Polytope& hull, int face, const Eigen::Vector3d& point);

/// The part of a polygon, or of a segment if it has two points, above a face: within the planes through the face's
/// edges along its normal.
Points above_face(const Points& vertices, const std::vector<int>& face, const Eigen::Vector3d& normal, Points polygon);

/// The part of a polygon that is behind a plane.
Points behind(const Plane& plane, const Points& polygon);

/// The depth of the deepest point; 0 if there are no points [m].
double depth_of(const std::vector<TouchPoint>& touches);

/// Selects at most `max_touches` points: the deepest, then always the point that is farthest from those selected
/// before.
std::vector<TouchPoint> spread_out(std::vector<TouchPoint> touches);

/// Points of another shape that are under a plane of the hull, as touches along its normal.
std::vector<TouchPoint> under_plane(const Plane& plane, const Points& points);

}  // namespace rehearse
