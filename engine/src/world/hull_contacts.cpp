#include "hull_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "hull_parts.h"

namespace rehearse {
namespace {

using Eigen::Vector3d;

/// The plane of one hull with the largest separation from the other hull.
struct FaceAxis {
  int face = -1;
  int vertex = -1;  // of the other hull, the nearest to the plane
  double separation = -std::numeric_limits<double>::infinity();
};

FaceAxis best_face(const std::vector<Plane>& planes, const Points& others) {
  FaceAxis best;
  for (std::size_t face = 0; face < planes.size(); ++face) {
    const int vertex = farthest_along(others, -planes[face].normal);
    const double separation = planes[face].distance(others[vertex]);
    if (separation <= best.separation) continue;
    best = {static_cast<int>(face), vertex, separation};
    if (separation > 0.0) break;
  }
  return best;
}

/// A pair of edges, one of each hull, whose common normal is a direction out of `hull`.
struct EdgeAxis : Axis {
  std::array<Vector3d, 4> ends;  // of the hull's edge, then of the other hull's edge
};

struct Extent {
  Vector3d low, high;

  bool meets(const Extent& other, double margin) const {
    return ((low - other.high).array() <= margin).all() && ((other.low - high).array() <= margin).all();
  }
};

Extent bounds_of(const Vector3d& a, const Vector3d& b) { return {a.cwiseMin(b), a.cwiseMax(b)}; }

Extent bounds_of(const Points& points) {
  Extent bounds{points[0], points[0]};
  for (const Vector3d& point : points) bounds = {bounds.low.cwiseMin(point), bounds.high.cwiseMax(point)};
  return bounds;
}

/// An edge in the common frame.
struct PlacedEdge {
  Vector3d from, to;
  const Vector3d *left, *right;  // normals of its faces
  Extent bounds;
};

/// The edges whose bounds are nearer than `margin` to the bounds `something`.
std::vector<PlacedEdge> edges_near(const Polytope& of, const Points& vertices, const std::vector<Plane>& planes,
                                   const Extent& something, double margin) {
  std::vector<PlacedEdge> near;
  for (const PolytopeEdge& edge : of.edges()) {
    const Vector3d &from = vertices[edge.from], &to = vertices[edge.to];
    const Extent bounds = bounds_of(from, to);
    if (bounds.meets(something, margin))
      near.push_back({from, to, &planes[edge.left].normal, &planes[edge.right].normal, bounds});
  }
  return near;
}

/// True if the edges form a face of the Minkowski difference: their arcs on the Gauss map cross.
bool arcs_cross(const PlacedEdge& a, const PlacedEdge& b) {
  const Vector3d along_a = a.to - a.from, along_b = b.to - b.from;
  const double left_b = -b.left->dot(along_a), right_b = -b.right->dot(along_a);
  const double left_a = a.left->dot(along_b), right_a = a.right->dot(along_b);
  // the arcs cross only if they are on the same hemisphere
  return left_b * right_b < 0.0 && left_a * right_a < 0.0 && left_b * right_a > 0.0;
}

double separation_along(const Vector3d& direction, const Points& hull, const Points& other) {
  return other[farthest_along(other, -direction)].dot(direction) - hull[farthest_along(hull, direction)].dot(direction);
}

/// The best pair of edges, if it is better than `separation`. Edges that touch with an overlap of d, or a gap of g, are
/// at most d or g apart: `margin` is an upper bound of both.
EdgeAxis best_edges(const Polytope& hull, const PlacedPolytope& other, double separation, double margin) {
  EdgeAxis best;
  best.separation = separation;
  const auto edges = edges_near(hull, hull.vertices(), hull.planes(), bounds_of(other.vertices), margin);
  const auto others = edges_near(other.shape, other.vertices, other.planes, bounds_of(hull.vertices()), margin);
  for (const PlacedEdge& a : edges) {
    for (const PlacedEdge& b : others) {
      if (!a.bounds.meets(b.bounds, margin) || !arcs_cross(a, b)) continue;
      const Vector3d along_a = a.to - a.from, along_b = b.to - b.from;
      Vector3d direction = along_a.cross(along_b);
      constexpr double parallel = 1e-9;
      if (direction.squaredNorm() <= parallel * parallel * along_a.squaredNorm() * along_b.squaredNorm()) continue;
      direction.normalize();
      if (direction.dot(a.from - hull.center()) < 0.0) direction = -direction;
      if (direction.dot(b.from - a.from) <= best.separation) continue;
      const double true_separation = separation_along(direction, hull.vertices(), other.vertices);
      if (true_separation <= best.separation) continue;
      best.direction = direction;
      best.separation = true_separation;
      best.ends = {a.from, a.to, b.from, b.to};
    }
  }
  return best;
}

/// The face at a vertex whose normal is nearest to a direction.
int face_towards(const Polytope& hull, const std::vector<Plane>& planes, int vertex, const Vector3d& direction) {
  int best = -1;
  for (const int face : hull.faces_at(vertex))
    if (best < 0 || planes[face].normal.dot(direction) > planes[best].normal.dot(direction)) best = face;
  return best;
}

/// The contact points of a face of one hull with the other hull, whose vertex `vertex` is the nearest to it.
std::vector<TouchPoint> touch_face(const Points& vertices, const std::vector<int>& face, const Plane& plane,
                                   const Points& others, const std::vector<int>& incident, int vertex) {
  Points polygon;
  for (const int corner : incident) polygon.push_back(others[corner]);
  std::vector<TouchPoint> touches = under_plane(plane, above_face(vertices, face, plane.normal, std::move(polygon)));
  if (touches.empty()) touches = under_plane(plane, {others[vertex]});  // the vertex is beside the face
  return spread_out(std::move(touches));
}

}  // namespace

std::vector<TouchPoint> touch_hull(const Polytope& hull, const PlacedPolytope& other) {
  const FaceAxis mine = best_face(hull.planes(), other.vertices);
  if (mine.separation > 0.0) return {};
  const FaceAxis theirs = best_face(other.planes, hull.vertices());
  if (theirs.separation > 0.0) return {};
  const double separation = std::max(mine.separation, theirs.separation);

  const Vector3d& vertex = other.vertices[mine.vertex];
  const double gap = (nearest_on_face(hull, mine.face, vertex) - vertex).norm();
  const EdgeAxis edges = best_edges(hull, other, separation, std::max(-separation, gap));
  if (edges.separation > 0.0) return {};
  // Faces are preferred, those of `hull` first: alternating between a point and a face would rock a resting body.
  constexpr double share = 0.95, rounding = 1e-6;
  if (edges.separation > share * separation + rounding) {
    const auto [on_hull, on_other] = nearest_of_segments(edges.ends[0], edges.ends[1], edges.ends[2], edges.ends[3]);
    return {{0.5 * (on_hull + on_other), edges.direction, -edges.separation}};
  }
  if (theirs.separation <= share * mine.separation + rounding) {
    const Plane& plane = hull.planes()[mine.face];
    const int incident = face_towards(other.shape, other.planes, mine.vertex, -plane.normal);
    return touch_face(hull.vertices(), hull.faces()[mine.face], plane, other.vertices, other.shape.faces()[incident],
                      mine.vertex);
  }
  const Plane& plane = other.planes[theirs.face];
  const int incident = face_towards(hull, hull.planes(), theirs.vertex, -plane.normal);
  std::vector<TouchPoint> touches = touch_face(other.vertices, other.shape.faces()[theirs.face], plane, hull.vertices(),
                                               hull.faces()[incident], theirs.vertex);
  for (TouchPoint& touch : touches) touch.normal = -touch.normal;
  return touches;
}

}  // namespace rehearse
