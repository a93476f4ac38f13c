// Hulls against spheres, capsules and cylinders.

#include <algorithm>
#include <array>
#include <cmath>

#include "hull_contacts.h"
#include "hull_parts.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

constexpr double almost_along = 0.999;  // cosine; directions that differ by less than 2.6 degrees count as equal
constexpr double almost_all = 0.95;     // of the depth: the deepest points may be beside the touching face

/// A point of a hull's surface and its distance from a point outside.
struct Nearest {
  Vector3d on_hull, on_other;
  double distance = std::numeric_limits<double>::infinity();

  void take(const Vector3d& hull, const Vector3d& other) {
    if (const double length = (other - hull).norm(); length < distance) *this = {hull, other, length};
  }
};

/// The plane with the largest distance from a point: farthest before it, or least behind it.
int outermost_plane(const std::vector<Plane>& planes, const Vector3d& point) {
  int best = 0;
  for (std::size_t i = 1; i < planes.size(); ++i)
    if (planes[i].distance(point) > planes[best].distance(point)) best = static_cast<int>(i);
  return best;
}

/// The nearest point of a hull to a point outside; considers only faces that are nearer than `reach`.
void take_nearest(const Polytope& hull, const Vector3d& point, double reach, Nearest& nearest) {
  for (std::size_t face = 0; face < hull.faces().size(); ++face) {
    const double distance = hull.planes()[face].distance(point);
    if (distance > 0.0 && distance <= reach) nearest.take(nearest_on_face(hull, static_cast<int>(face), point), point);
  }
}

/// The contact of a surface point of the hull with a round body of that radius about a point outside.
TouchPoint touch_of(const Nearest& nearest, const Vector3d& normal, double radius) {
  const double depth = radius - nearest.distance;
  return {nearest.on_hull - 0.5 * depth * normal, normal, depth};
}

/// The hull's face whose normal has this direction, or -1.
int face_along(const Polytope& hull, const Vector3d& direction) {
  int best = -1;
  double most = almost_along;
  for (std::size_t face = 0; face < hull.planes().size(); ++face) {
    const double cosine = hull.planes()[face].normal.dot(direction);
    if (cosine <= most) continue;
    most = cosine;
    best = static_cast<int>(face);
  }
  return best;
}

/// Of points above a face, those that are nearer to it than `radius`, as contacts.
std::vector<TouchPoint> touch_face(const Polytope& hull, int face, double radius, Points points) {
  const Plane& plane = hull.planes()[face];
  points = above_face(hull.vertices(), hull.faces()[face], plane.normal, std::move(points));
  for (Vector3d& point : points) point -= radius * plane.normal;
  return under_plane(plane, points);
}

/// Keeps the direction with the larger separation.
void take_axis(Axis& best, const Vector3d& direction, double separation) {
  if (separation > best.separation) best = {direction, separation};
}

/// The common normal of a line and a hull's edge, out of the hull, if it is one of the hull's directions at that edge;
/// else zero.
Vector3d common_normal(const Polytope& hull, const PolytopeEdge& edge, const Vector3d& along) {
  const Vector3d &left = hull.planes()[edge.left].normal, &right = hull.planes()[edge.right].normal;
  if (left.dot(along) * right.dot(along) >= 0.0) return Vector3d::Zero();
  const Vector3d direction = (hull.vertices()[edge.to] - hull.vertices()[edge.from]).cross(along);
  constexpr double parallel = 1e-12;
  if (direction.norm() < parallel) return Vector3d::Zero();
  return direction.dot(left + right) < 0.0 ? Vector3d(-direction.normalized()) : Vector3d(direction.normalized());
}

/// The direction in which a segment overlaps the hull least, or has the largest distance from a face or edge.
Axis segment_axis(const Polytope& hull, const Vector3d& from, const Vector3d& to) {
  Axis best;
  for (const Plane& plane : hull.planes())
    take_axis(best, plane.normal, std::min(plane.distance(from), plane.distance(to)));
  for (const PolytopeEdge& edge : hull.edges()) {
    const Vector3d normal = common_normal(hull, edge, to - from);
    if (!normal.isZero(0.0)) take_axis(best, normal, normal.dot(from - hull.vertices()[edge.from]));
  }
  return best;
}

/// The separation of a cylinder from the hull along directions.
class CylinderSupport {
 public:
  explicit CylinderSupport(const Round& cylinder) : cylinder_(cylinder) {}

  /// The lowest point's height along a unit direction [m].
  double lowest(const Vector3d& direction) const {
    const double cosine = cylinder_.axis().dot(direction);
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return direction.dot(cylinder_.center) - cylinder_.half_length * std::abs(cosine) - cylinder_.radius * sine;
  }

  /// A unit vector from the axis towards the lowest points; any direction if the direction is along the axis.
  Vector3d down(const Vector3d& direction) const {
    const Vector3d across = direction - direction.dot(cylinder_.axis()) * cylinder_.axis();
    constexpr double least = 1e-9;
    return across.norm() < least ? Vector3d(cylinder_.axes.col(0)) : Vector3d(-across.normalized());
  }

  /// The largest distance of any of its points from `point` [m].
  double reach_from(const Vector3d& point) const {
    return (cylinder_.center - point).norm() + cylinder_.half_length + cylinder_.radius;
  }

  /// The centre of the end cap that faces against the direction.
  Vector3d lower_end(const Vector3d& direction) const {
    const double side = cylinder_.axis().dot(direction) > 0.0 ? -1.0 : 1.0;
    return cylinder_.center + side * cylinder_.half_length * cylinder_.axis();
  }

 private:
  const Round& cylinder_;
};

/// The best direction between those of an edge's two faces, where the edge touches the rim of an end.
void take_rim(const Polytope& hull, const PolytopeEdge& edge, const CylinderSupport& support, Axis& best) {
  const Vector3d &left = hull.planes()[edge.left].normal, &right = hull.planes()[edge.right].normal;
  const Vector3d& corner = hull.vertices()[edge.from];
  const auto direction_at = [&](double share) { return Vector3d(((1.0 - share) * left + share * right).normalized()); };
  const auto separation_at = [&](double share) {
    const Vector3d direction = direction_at(share);
    return support.lowest(direction) - direction.dot(corner);
  };
  constexpr int samples = 8;
  double highest = -std::numeric_limits<double>::infinity();
  int at = 0;
  for (int i = 1; i < samples; ++i) {
    const double separation = separation_at(i / double(samples));
    if (separation > highest) at = i;
    highest = std::max(highest, separation);
  }
  // between two samples the separation can't rise by more than the angle times the farthest point's distance from the
  // edge
  const double angle = std::acos(std::clamp(left.dot(right), -1.0, 1.0));
  if (highest + angle * support.reach_from(corner) / samples <= best.separation) return;
  double low = (at - 1) / double(samples), high = (at + 1) / double(samples);
  for (int round = 0; round < 40; ++round) {  // 2/3 to the power of 40 is 1e-7
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    if (separation_at(a) < separation_at(b))
      low = a;
    else
      high = b;
  }
  take_axis(best, direction_at(0.5 * (low + high)), separation_at(0.5 * (low + high)));
}

/// The direction in which a cylinder overlaps the hull least: the best of the faces, and the best of all.
struct CylinderAxes {
  Axis face, any;
  int best_face = -1;
};

CylinderAxes cylinder_axes(const Polytope& hull, const Round& cylinder) {
  const CylinderSupport support(cylinder);
  const Vector3d axis = cylinder.axis();
  CylinderAxes axes;
  for (std::size_t i = 0; i < hull.planes().size(); ++i) {
    const Plane& plane = hull.planes()[i];
    const double separation = support.lowest(plane.normal) - plane.offset;
    if (separation > axes.face.separation) axes.best_face = static_cast<int>(i);
    take_axis(axes.face, plane.normal, separation);
  }
  axes.any = axes.face;
  if (axes.any.separation > 0.0) return axes;
  const auto take_checked = [&](const Vector3d& direction) {
    const Vector3d& highest = hull.vertices()[farthest_along(hull.vertices(), direction)];
    take_axis(axes.any, direction, support.lowest(direction) - direction.dot(highest));
  };
  take_checked(axis);
  take_checked(-axis);
  double nearest = std::numeric_limits<double>::infinity();
  Vector3d from_vertex = Vector3d::Zero();
  for (const Vector3d& vertex : hull.vertices()) {
    const Vector3d arm = cylinder.center - vertex;
    const Vector3d across = arm - arm.dot(axis) * axis;
    if (across.norm() >= nearest) continue;
    nearest = across.norm();
    from_vertex = across;
  }
  constexpr double least = 1e-9;
  if (nearest > least) take_checked(from_vertex / nearest);
  for (const PolytopeEdge& edge : hull.edges()) {
    const Vector3d normal = common_normal(hull, edge, axis);
    if (!normal.isZero(0.0))
      take_axis(axes.any, normal, support.lowest(normal) - normal.dot(hull.vertices()[edge.from]));
    if (axes.any.separation > 0.0) return axes;
  }
  return axes;
}

/// The contact points of a cylinder's end or side on a face of the hull.
std::vector<TouchPoint> touch_face_with_cylinder(const Polytope& hull, int face, const Round& cylinder) {
  const CylinderSupport support(cylinder);
  const Plane& plane = hull.planes()[face];
  const Vector3d down = support.down(plane.normal);
  const Vector3d end = support.lower_end(plane.normal);
  Points points;
  if (std::abs(plane.normal.dot(cylinder.axis())) < std::sqrt(0.5)) {  // the side: its lowest line
    for (const double side : {-1.0, 1.0})
      points.push_back(cylinder.center + side * cylinder.half_length * cylinder.axis() + cylinder.radius * down);
  } else {  // an end: its rim, and the rim's lowest point
    constexpr int corners = 16;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * M_PI * i / corners;
      points.push_back(end + cylinder.radius *
                                 (std::cos(angle) * cylinder.axes.col(0) + std::sin(angle) * cylinder.axes.col(1)));
    }
  }
  std::vector<TouchPoint> touches =
      under_plane(plane, above_face(hull.vertices(), hull.faces()[face], plane.normal, std::move(points)));
  const Vector3d lowest = end + cylinder.radius * down;
  if (!above_face(hull.vertices(), hull.faces()[face], plane.normal, {lowest, lowest}).empty())
    for (const TouchPoint& touch : under_plane(plane, {lowest})) touches.push_back(touch);
  // the point may be beside the face
  if (depth_of(touches) < almost_all * -plane.distance(lowest)) touches = under_plane(plane, {lowest});
  return spread_out(std::move(touches));
}

/// The contact points of a corner, an edge or a face of the hull on a cylinder's end, side, or rim.
std::vector<TouchPoint> touch_cylinder_with_hull(const Polytope& hull, const Round& cylinder, const Axis& axis) {
  const CylinderSupport support(cylinder);
  const double low = support.lowest(axis.direction);
  const Plane lower{-axis.direction, -low};  // of the cylinder: hull points before this plane don't overlap it
  const int highest = farthest_along(hull.vertices(), axis.direction);
  const double cosine = std::abs(axis.direction.dot(cylinder.axis()));
  constexpr double almost = 1e-6;
  Points points;
  if (cosine > almost_along) {  // an end: the part of the hull's highest face within its circle
    int face = hull.faces_at(highest).front();
    for (const int other : hull.faces_at(highest))
      if (hull.planes()[other].normal.dot(axis.direction) > hull.planes()[face].normal.dot(axis.direction))
        face = other;
    for (const int vertex : hull.faces()[face]) points.push_back(hull.vertices()[vertex]);
    const Vector3d end = support.lower_end(axis.direction);
    constexpr int sides = 16;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2.0 * M_PI * i / sides;
      const Vector3d outward = std::cos(angle) * cylinder.axes.col(0) + std::sin(angle) * cylinder.axes.col(1);
      points = behind({outward, outward.dot(end) + std::cos(M_PI / sides) * cylinder.radius}, points);
    }
  } else {  // the hull's highest edges, or its highest corner
    for (const PolytopeEdge& edge : hull.edges()) {
      const Vector3d &from = hull.vertices()[edge.from], &to = hull.vertices()[edge.to];
      const double top = axis.direction.dot(hull.vertices()[highest]);
      const double size = (to - from).norm();
      if (top - axis.direction.dot(from) > almost * size || top - axis.direction.dot(to) > almost * size) continue;
      const Vector3d line = cylinder.half_length * cylinder.axis();
      const Vector3d lowest = cylinder.center + cylinder.radius * support.down(axis.direction);
      if (cosine > almost) {
        points.push_back(nearest_on_segment(
            from, to, support.lower_end(axis.direction) + cylinder.radius * support.down(axis.direction)));
      } else if ((to - from).cross(cylinder.axis()).norm() < 1e-3 * size) {  // the edge is parallel to the axis
        for (const Vector3d& point :
             behind({cylinder.axis(), cylinder.axis().dot(cylinder.center + line)},
                    behind({-cylinder.axis(), -cylinder.axis().dot(cylinder.center - line)}, {from, to})))
          points.push_back(point);
      } else {
        points.push_back(nearest_of_segments(from, to, lowest - line, lowest + line).first);
      }
    }
  }
  std::vector<TouchPoint> touches = under_plane(lower, points);
  if (depth_of(touches) < almost_all * -axis.separation) touches = under_plane(lower, {hull.vertices()[highest]});
  for (TouchPoint& touch : touches) touch.normal = axis.direction;
  return spread_out(std::move(touches));
}

}  // namespace

std::vector<TouchPoint> touch_sphere(const Polytope& hull, const Vector3d& center, double radius) {
  const Plane& plane = hull.planes()[outermost_plane(hull.planes(), center)];
  const double height = plane.distance(center);
  if (height > radius) return {};
  if (height <= 0.0) return under_plane(plane, {center - radius * plane.normal});
  Nearest nearest;
  take_nearest(hull, center, radius, nearest);
  if (nearest.distance > radius) return {};
  return {touch_of(nearest, (center - nearest.on_hull) / nearest.distance, radius)};
}

std::vector<TouchPoint> touch_capsule(const Polytope& hull, const Round& capsule) {
  const Vector3d from = capsule.center - capsule.half_length * capsule.axis();
  const Vector3d to = capsule.center + capsule.half_length * capsule.axis();
  Axis axis = segment_axis(hull, from, to);
  if (axis.separation > capsule.radius) return {};
  Nearest nearest;
  if (axis.separation > 0.0) {
    for (const Vector3d& end : {from, to}) take_nearest(hull, end, capsule.radius, nearest);
    for (const PolytopeEdge& edge : hull.edges()) {
      const auto [on_edge, on_capsule] =
          nearest_of_segments(hull.vertices()[edge.from], hull.vertices()[edge.to], from, to);
      nearest.take(on_edge, on_capsule);
    }
    if (nearest.distance > capsule.radius) return {};
    axis.direction = (nearest.on_other - nearest.on_hull) / nearest.distance;
  }
  const double depth = capsule.radius - (axis.separation > 0.0 ? nearest.distance : axis.separation);
  if (const int face = face_along(hull, axis.direction); face >= 0) {
    auto touches = touch_face(hull, face, capsule.radius, {from, to});
    if (depth_of(touches) >= almost_all * depth) return touches;  // else the deepest contact is beside that face
  }
  if (axis.separation > 0.0) return {touch_of(nearest, axis.direction, capsule.radius)};
  // deep overlap: the cylinder's middle line is inside the hull
  const Vector3d& low = axis.direction.dot(from) < axis.direction.dot(to) ? from : to;
  return {{low + (0.5 * depth - capsule.radius) * axis.direction, axis.direction, depth}};
}

std::vector<TouchPoint> touch_cylinder(const Polytope& hull, const Round& cylinder) {
  CylinderAxes axes = cylinder_axes(hull, cylinder);
  if (axes.any.separation > 0.0) return {};
  const CylinderSupport support(cylinder);
  for (const PolytopeEdge& edge : hull.edges()) take_rim(hull, edge, support, axes.any);
  if (axes.any.separation > 0.0) return {};
  constexpr double rounding = 1e-6;  // faces are preferred, as between hulls
  if (axes.any.separation <= almost_all * axes.face.separation + rounding)
    return touch_face_with_cylinder(hull, axes.best_face, cylinder);
  return touch_cylinder_with_hull(hull, cylinder, axes.any);
}

}  // namespace rehearse
