// Converts assimp's scene to the parts of a mesh.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <string>
#include <vector>

#include "mesh/mesh_file.h"
#include "mesh/mesh_format.h"
#include "mesh_materials.h"

struct aiScene;

namespace rehearse {

/// The triangles of all nodes in the order of the tree, in the shape's frame: one part for each object and material,
/// in the order of their first triangles. With a selection only those of the selected node; an error if there is none.
Result<std::vector<MeshPart>> read_parts(const aiScene& scene, MeshFormat format, const MeshMaterials& materials,
                                         const Eigen::Vector3d& scale, const MeshSelection& selection);

/// True if a node of the scene, or a mesh of a node, has that name.
bool has_node(const aiScene& scene, const std::string& name);

}  // namespace rehearse
