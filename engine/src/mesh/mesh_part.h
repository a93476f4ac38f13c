// What all readers of mesh files do with vertices and triangles, and the reader of binary STL.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh_file.h"
#include "mesh_format.h"

namespace rehearse {

using MeshMatrix = Eigen::Matrix<double, 3, 4>;  // an affine map

MeshMatrix product(const MeshMatrix& outer, const MeshMatrix& inner);

/// The transform from the file's frame to the shape's.
MeshMatrix placing_of(MeshFormat format, const Eigen::Vector3d& scale, bool z_up);

/// Adds a vertex of the file. False: it isn't finite.
bool add_vertex(const MeshMatrix& place, const Eigen::Vector3d& of_file, MeshPart& part);
Diagnostic not_finite();

bool mirrors(const MeshMatrix& place);

/// The normal of a triangle, by its winding; z if it has no area.
Eigen::Vector3f normal_of(const MeshPart& part, const std::array<std::uint32_t, 3>& triangle);

/// Gives each triangle separate vertices, with its normal.
void flatten(MeshPart& part);

/// The triangles of a binary STL that check_mesh_bytes() accepted: bit for bit those of assimp's scene, whose copies
/// need five times the memory of the file.
Result<std::vector<MeshPart>> read_binary_stl(const std::string& bytes, const Eigen::Vector3d& scale, bool z_up);

}  // namespace rehearse
