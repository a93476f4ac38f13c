// The triangles of a VRML97 file.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <string>
#include <vector>

#include "mesh_file.h"
#include "mesh_input.h"

namespace rehearse {

/// One part for each Shape and colour; a Shape is a separate object. Reads Transform, Group, Anchor, Billboard,
/// Collision, Switch, LOD (its first level), Inline, and Shape with IndexedFaceSet, Box, Sphere, Cylinder, Cone,
/// Extrusion or ElevationGrid. Other nodes are ignored. Colours of vertices become one colour per face.
Result<std::vector<MeshPart>> read_vrml_parts(MeshInput& input, const MeshSelection& selection,
                                              const Eigen::Vector3d& scale, std::vector<std::string>& warnings);

}  // namespace rehearse
