#include "polytope.h"

#include <algorithm>
#include <map>
#include <utility>

namespace rehearse {
namespace {

using Eigen::Vector3d;

ConvexHull hull_of(const Box& box) {
  ConvexHull hull;
  for (int corner = 0; corner < 8; ++corner)
    hull.vertices.push_back(
        box.size.cwiseProduct(Vector3d(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5)));
  hull.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  return hull;
}

}  // namespace

Polytope::Polytope(const ConvexHull& hull) : hull_(hull) {
  REHEARSE_ASSERT(hull.vertices.size() >= 4 && hull.faces.size() >= 4, "a hull has a volume");
  center_ = Vector3d::Zero();
  for (const Vector3d& vertex : vertices()) center_ += vertex / static_cast<double>(vertices().size());
  find_planes();
  find_edges();
}

Polytope::Polytope(const Box& box) : Polytope(hull_of(box)) {}

void Polytope::find_planes() {
  for (const std::vector<int>& face : faces()) {
    Vector3d normal = Vector3d::Zero();  // Newell's, about the first vertex
    const Vector3d& first = vertices()[face[0]];
    for (std::size_t i = 1; i + 1 < face.size(); ++i)
      normal += (vertices()[face[i]] - first).cross(vertices()[face[i + 1]] - first);
    Plane plane{normal.normalized(), 0.0};
    plane.offset = plane.normal.dot(first);
    for (const Vector3d& vertex : vertices()) plane.offset = std::max(plane.offset, plane.normal.dot(vertex));
    planes_.push_back(plane);
  }
}

void Polytope::find_edges() {
  faces_at_.resize(vertices().size());
  std::map<std::pair<int, int>, int> left;  // the face on the left of an edge
  for (std::size_t face = 0; face < faces().size(); ++face) {
    const std::vector<int>& outline = faces()[face];
    for (std::size_t i = 0; i < outline.size(); ++i) {
      left[{outline[i], outline[(i + 1) % outline.size()]}] = static_cast<int>(face);
      faces_at_[outline[i]].push_back(static_cast<int>(face));
    }
  }
  for (const auto& [edge, face] : left) {
    const auto other = left.find({edge.second, edge.first});
    REHEARSE_ASSERT(other != left.end(), "a hull is closed");
    if (edge.first < edge.second) edges_.push_back({edge.first, edge.second, face, other->second});
  }
}

PlacedPolytope::PlacedPolytope(const Polytope& of, const Eigen::Isometry3d& pose)
    : shape(of), center(pose * of.center()) {
  vertices.reserve(of.vertices().size());
  for (const Vector3d& vertex : of.vertices()) vertices.push_back(pose * vertex);
  planes.reserve(of.planes().size());
  for (const Plane& plane : of.planes()) {
    const Vector3d normal = pose.linear() * plane.normal;
    planes.push_back({normal, plane.offset + normal.dot(pose.translation())});
  }
}

}  // namespace rehearse
