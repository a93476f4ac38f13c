// Reads a mesh from a file, by assimp.
//
// - STL, binary or ASCII: binary is what has the size of a binary one. Normals follow from the winding, a triangle at a
//   time: those in the file are often wrong or zero. Colours in it don't count.
// - DAE: the up axis is ignored, as RViz and Gazebo do, and the unit applied. Transforms of nodes are applied; cameras,
//   lights, lines and points passed over.
// - OBJ: polygons become triangles; each object or group with faces has an `object` number of its own. In all other
//   formats the whole file is one object.
// - glTF and GLB: y is up by the standard, so they are turned: (x, y, z) becomes (x, -z, y).
// Vertices keep the bits of the file's floats where no transform and no scale changes them. Mirrored nodes and scales
// turn the winding with them, so that the outside stays outside. Normals that a file doesn't have are those of the
// triangles. mesh_materials.h says what colours there are.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <filesystem>
#include <string>
#include <vector>

namespace rehearse {

struct MeshReading {
  MeshData data;
  std::vector<std::string> warnings;  // what of its looks couldn't be had. No path of the machine stands in them
};

/// `scale` per axis, of the shape's frame; negative mirrors. Never throws. Fails if the file can't be read, is of no
/// known format, has more than max_mesh_bytes or max_mesh_triangles, no triangle, or a vertex that isn't finite.
Result<MeshReading> read_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale);

}  // namespace rehearse
