// Polytope: a convex hull with planes, edges and a centre, for contacts and beams. Private to the world library.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <vector>

namespace rehearse {

/// A plane. Points x with normal·x <= offset are behind it.
struct Plane {
  Eigen::Vector3d normal;  // unit length
  double offset;           // [m]

  /// Distance of a point from the plane; positive before it, negative behind it [m].
  double distance(const Eigen::Vector3d& point) const { return normal.dot(point) - offset; }
};

struct PolytopeEdge {
  int from, to;     // vertices
  int left, right;  // faces; `left` runs from `from` to `to`
};

class Polytope {
 public:
  explicit Polytope(const ConvexHull& hull);
  explicit Polytope(const Box& box);

  const std::vector<Eigen::Vector3d>& vertices() const { return hull_.vertices; }  // [m]
  const std::vector<std::vector<int>>& faces() const { return hull_.faces; }       // counter-clockwise from outside
  const std::vector<Plane>& planes() const { return planes_; }                     // by face; all vertices are behind
  const std::vector<PolytopeEdge>& edges() const { return edges_; }
  const std::vector<int>& faces_at(int vertex) const { return faces_at_[vertex]; }
  const Eigen::Vector3d& center() const { return center_; }  // a point inside

 private:
  void find_planes();
  void find_edges();

  ConvexHull hull_;
  std::vector<Plane> planes_;
  std::vector<PolytopeEdge> edges_;
  std::vector<std::vector<int>> faces_at_;  // by vertex
  Eigen::Vector3d center_;
};

/// A polytope transformed into a different frame.
struct PlacedPolytope {
  PlacedPolytope(const Polytope& of, const Eigen::Isometry3d& pose);

  const Polytope& shape;  // outlives this
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Plane> planes;
  Eigen::Vector3d center;
};

}  // namespace rehearse
