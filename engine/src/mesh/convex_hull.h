// What contact takes a mesh for: one convex hull an object. Private to the engine.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <cstddef>
#include <vector>

namespace rehearse {

/// A hull has no more vertices than that. Two hulls of 128 vertices that touch cost up to 0.1 ms a step, of 64 about
/// 10 µs; on a box 0.04 and 0.014 ms, a cylinder 0.05 and 0.02 ms, a sphere 2 and 1 µs.
inline constexpr std::size_t max_hull_vertices = 128;
/// What is as flat as a sheet is taken to be that thick [m].
inline constexpr double sheet_thickness = 1e-3;

struct ConvexHulls {
  std::vector<ConvexHull> hulls;  // one a number of MeshPart::object, ascending
  Diagnostics remarks;            // objects that contact takes for something else than they are: notes and warnings
};

/// The convex hull of each object of a mesh. Triangles of a hull that lie in one plane, to a millionth of its size, are
/// one polygon. The same bits whatever the order of the mesh's triangles and vertices.
///
/// A hull with more than `max_hull_vertices` is thinned: of its vertices some stay, round by round those that are
/// farthest outside of the hull of those before. So it lies inside of the true hull, and a remark tells how far a
/// vertex sticks out of it (of a sphere's radius about 3 %). An object without thickness gets `sheet_thickness`, with a
/// remark; one that is only a line or a point is an error. Messages speak of "it", or of "object 1" if there are several,
/// and don't say which mesh.
Result<ConvexHulls> convex_hulls(const MeshData& mesh);

}  // namespace rehearse
