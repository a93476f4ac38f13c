// Whether a mesh is the surface of a solid. Internal.
#pragma once

#include <rehearse/model.h>

#include <vector>

namespace rehearse {

/// For each part, whether its object is closed and wound the right way round: each edge of a triangle is that of
/// another one in the opposite direction, and the volume inside is above zero. Places are compared bit by bit, so a
/// seam that doesn't quite meet is open. Vertices are finite.
std::vector<bool> closed_parts(const MeshData& mesh);

}  // namespace rehearse
