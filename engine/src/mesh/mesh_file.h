// Reads a mesh from a file, by assimp, a reader of VRML and one of binary STL.
//
// - STL, binary or ASCII: a file is binary if it has the size of a binary one. Normals are computed per triangle from
//   the winding, because the file's normals are often wrong or zero. Colours in the file are ignored.
// - DAE: the up axis is ignored, as in RViz and Gazebo, and the unit is applied. Transforms of nodes are applied;
//   cameras, lights, lines and points are ignored.
// - OBJ: polygons become triangles; each object or group with faces has a separate `object` number. In all other
//   formats the whole file is one object.
// - WRL: VRML97, by Rehearse's own reader (vrml_scene.h), since assimp 5.2 has none.
// - glTF and GLB: y is up by the standard, so they are turned: (x, y, z) becomes (x, -z, y); not if the
//   selection says that z is up.
// Vertices keep the bits of the file's floats where no transform and no scale changes them. Mirrored nodes and scales
// reverse the winding as well, so that the outside stays outside. If a file has no normals, those of the triangles are
// used. mesh_materials.h describes the colours.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rehearse {

/// The part of a mesh file that is wanted, and how it is read.
struct MeshSelection {
  /// The node of that name, without the translations of it and above it: in VRML that of DEF, in a DAE its name or its
  /// id, in an OBJ a group or object, in an STL a solid.
  std::string node = {};
  std::set<std::string> without = {};  // nodes of these names are left out
  bool z_up = false;                   // a glTF file has z up, against its standard: it isn't turned
};

struct MeshReading {
  MeshData data;
  std::vector<std::string> warnings;  // missing textures and the like; without absolute paths
};

/// `scale` per axis, of the shape's frame; negative mirrors. Never throws. Fails if the file can't be read, is of no
/// known format, has more than max_mesh_bytes or max_mesh_triangles, no triangle, or a vertex that isn't finite.
Result<MeshReading> read_mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                              const MeshSelection& selection = {});

/// The error for a selected node that a file doesn't have; `names`: of its nodes.
Diagnostic no_such_node(const std::string& wanted, const std::vector<std::string>& names);

}  // namespace rehearse
