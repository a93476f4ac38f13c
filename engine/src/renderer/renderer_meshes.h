// Meshes of the shapes in unit size, so that one mesh serves all shapes of a kind.
//
// The place of a vertex is `position` times the shape's scale (per axis), moved along z by `shift` times the shape's
// stretch. Only a capsule is stretched: its caps are scaled by the radius, then moved apart by half the length.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace rehearse {

struct Vertex {
  std::array<float, 3> position;
  std::array<float, 3> normal;  // unit vector; no shape's scale changes its direction
  float shift;                  // -1, 0 or 1
};

/// Triangles, three indices each, counter-clockwise seen from outside.
struct UnitMesh {
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> indices;
};

UnitMesh box_mesh();       // edges of 1, centred
UnitMesh sphere_mesh();    // radius 1
UnitMesh cylinder_mesh();  // radius 1, length 1, along z, centred
UnitMesh capsule_mesh();   // radius 1, length 0, along z; the halves shift by -1 and 1

}  // namespace rehearse
