#include "hull_parts.h"

#include <algorithm>
#include <utility>

namespace rehearse {

using Eigen::Vector3d;

int farthest_along(const Points& vertices, const Vector3d& direction) {
  int best = 0;
  double most = vertices[0].dot(direction);
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const double along = vertices[i].dot(direction);
    if (along <= most) continue;
    most = along;
    best = static_cast<int>(i);
  }
  return best;
}

Vector3d nearest_on_segment(const Vector3d& from, const Vector3d& to, const Vector3d& point) {
  const Vector3d along = to - from;
  return from + std::clamp(along.dot(point - from) / along.squaredNorm(), 0.0, 1.0) * along;
}

// After C. Ericson, Real-Time Collision Detection, 5.1.9.
std::pair<Vector3d, Vector3d> nearest_of_segments(const Vector3d& from_a, const Vector3d& to_a, const Vector3d& from_b,
                                                  const Vector3d& to_b) {
  const Vector3d a = to_a - from_a, b = to_b - from_b, between = from_a - from_b;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const double determinant = aa * bb - ab * ab;
  constexpr double parallel = 1e-12;
  double s = 0.5;
  if (determinant > parallel * aa * bb)
    s = std::clamp((ab * b.dot(between) - bb * a.dot(between)) / determinant, 0.0, 1.0);
  const Vector3d on_b = nearest_on_segment(from_b, to_b, from_a + s * a);
  return {nearest_on_segment(from_a, to_a, on_b), on_b};
}

Vector3d nearest_on_face(const Polytope& hull, int face, const Vector3d& point) {
  const std::vector<int>& outline = hull.faces()[face];
  const Plane& plane = hull.planes()[face];
  const Vector3d foot = point - plane.distance(point) * plane.normal;
  bool within = true;
  Vector3d nearest = foot;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector3d& from = hull.vertices()[outline[i]];
    const Vector3d& to = hull.vertices()[outline[(i + 1) % outline.size()]];
    within = within && (to - from).cross(plane.normal).dot(foot - from) <= 0.0;
    const Vector3d on_edge = nearest_on_segment(from, to, point);
    const double distance = (on_edge - point).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = on_edge;
  }
  return within ? foot : nearest;
}

Points behind(const Plane& plane, const Points& polygon) {
  Points kept;
  const std::size_t sides = polygon.size() > 2 ? polygon.size() : polygon.size() / 2;  // a segment has only one side
  if (polygon.size() <= 2 && !polygon.empty() && plane.distance(polygon[0]) <= 0.0) kept.push_back(polygon[0]);
  for (std::size_t i = 0; i < sides; ++i) {
    const Vector3d& from = polygon[i];
    const Vector3d& to = polygon[(i + 1) % polygon.size()];
    const double before = plane.distance(from), after = plane.distance(to);
    if ((before <= 0.0) != (after <= 0.0)) kept.push_back(from + before / (before - after) * (to - from));
    if (after <= 0.0) kept.push_back(to);
  }
  return kept;
}

Points above_face(const Points& vertices, const std::vector<int>& face, const Vector3d& normal, Points polygon) {
  for (std::size_t i = 0; i < face.size() && !polygon.empty(); ++i) {
    const Vector3d& from = vertices[face[i]];
    const Vector3d& to = vertices[face[(i + 1) % face.size()]];
    const Vector3d outward = (to - from).cross(normal).normalized();
    polygon = behind({outward, outward.dot(from)}, polygon);
  }
  return polygon;
}

double depth_of(const std::vector<TouchPoint>& touches) {
  double depth = 0.0;
  for (const TouchPoint& touch : touches) depth = std::max(depth, touch.depth);
  return depth;
}

std::vector<TouchPoint> spread_out(std::vector<TouchPoint> touches) {
  if (touches.size() <= max_touches) return touches;
  const auto deepest =
      std::ranges::max_element(touches, [](const TouchPoint& a, const TouchPoint& b) { return a.depth < b.depth; });
  std::vector<TouchPoint> kept{*deepest};
  std::vector<double> distances(touches.size(), std::numeric_limits<double>::infinity());
  while (kept.size() < max_touches) {
    for (std::size_t i = 0; i < touches.size(); ++i)
      distances[i] = std::min(distances[i], (touches[i].position - kept.back().position).squaredNorm());
    kept.push_back(touches[static_cast<std::size_t>(std::ranges::max_element(distances) - distances.begin())]);
  }
  return kept;
}

std::vector<TouchPoint> under_plane(const Plane& plane, const Points& points) {
  std::vector<TouchPoint> touches;
  for (const Vector3d& point : points) {
    const double depth = -plane.distance(point);
    if (depth >= 0.0) touches.push_back({point + 0.5 * depth * plane.normal, plane.normal, depth});
  }
  return touches;
}

}  // namespace rehearse
