// Convex hulls of meshes, one per object. Contacts use them instead of the triangles. Private to the engine.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rehearse {

/// The largest number of vertices of a hull. Contact of two hulls of 128 vertices takes up to 0.1 ms per step, of 64
/// about 10 µs; with a box 0.04 and 0.014 ms, with a cylinder 0.05 and 0.02 ms, with a sphere 2 and 1 µs.
inline constexpr std::size_t max_hull_vertices = 128;
/// Thickness of the hull of a flat object [m].
inline constexpr double sheet_thickness = 1e-3;

struct ConvexHulls {
  std::vector<ConvexHull> hulls;  // one per number of MeshPart::object, ascending
  Diagnostics remarks;            // notes and warnings about objects whose hull differs from their true hull
};

/// The convex hull of each object of a mesh. Triangles of a hull that lie in one plane, to a millionth of its size, are
/// merged into one polygon. The result's bits don't depend on the order of the mesh's triangles and vertices.
///
/// A hull with more than `max_hull_vertices` is thinned: in each round it takes the vertices that are farthest outside
/// the hull of the vertices taken before. So it lies inside the true hull, and a remark reports how far a vertex is
/// outside the thinned hull (about 3 % of the radius for a sphere). An object without thickness gets `sheet_thickness`,
/// with a remark; an object that is only a line or a point is an error. Messages use "it", or "object 1" if there are
/// several objects, and don't name the mesh. `volumes`: gets, by the number of an object, hull_volume() of all points
/// of its triangles; not of objects without thickness. Null: they aren't wanted.
Result<ConvexHulls> convex_hulls(const MeshData& mesh, std::map<int, double>* volumes = nullptr);

/// The convex hull of points, likewise. `object` begins the messages: "it " or "object 1 ".
Result<ConvexHull> convex_hull(std::vector<Eigen::Vector3d> points, const std::string& object, Diagnostics& remarks);

/// The volume of the convex hull of points [m³]; 0 if they are flat or Qhull fails.
double hull_volume(std::vector<Eigen::Vector3d> points);

/// The numbers of a mesh's objects, ascending, and the beginning of messages about each: "it " or "object 1 ".
std::vector<std::pair<int, std::string>> objects_of(const MeshData& mesh);

/// The volume of a hull [m³].
double volume(const ConvexHull& hull);

}  // namespace rehearse
