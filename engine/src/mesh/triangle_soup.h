// Solids as lists of triangles, cut by planes. Private to the engine.
#pragma once

#include <rehearse/model.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace rehearse {

/// A plane: the points x with normal·x = offset.
struct CutPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  // unit length
  double offset = 0.0;                                // [m]
};

/// Triangles around a solid, counter-clockwise seen from outside, without order. Their corners are numbers of vertices.
struct TriangleSoup {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
};

/// The order of points: by x, then by y, then by z.
inline bool before(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// The triangles of an object of a mesh; vertices of one position become one.
TriangleSoup object_of(const MeshData& mesh, int object);

/// The same solid with fewer vertices: those of each cell of a grid of `cells` along the longest side become one.
TriangleSoup coarsened(const TriangleSoup& soup, int cells);

/// The parts of a soup that share no vertices, in the order of their first triangles; the whole if there are more than
/// `most`.
std::vector<TriangleSoup> separate_parts(const TriangleSoup& soup, std::size_t most);

/// True if the triangles at each edge cancel: the soup surrounds a volume.
bool is_closed(const TriangleSoup& soup);

/// The volume within a closed soup [m³]; negative if it is wound inwards.
double volume(const TriangleSoup& soup);

/// The parts of a solid behind and before a plane. Points within `tolerance` of the plane lie in it. Both get triangles
/// in the plane that close them; these may overlap, but their signed sum is the section.
std::pair<TriangleSoup, TriangleSoup> cut(const TriangleSoup& soup, const CutPlane& plane, double tolerance);

}  // namespace rehearse
