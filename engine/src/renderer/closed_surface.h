// Determines whether a mesh is the surface of a solid. Internal.
#pragma once

#include <rehearse/model.h>

#include <vector>

namespace rehearse {

/// For each part: true if its object is closed and wound outwards. That is: each edge of a triangle also belongs to
/// a different triangle, in the opposite direction, and the volume inside is above zero. Positions are compared bit by
/// bit, so an object with the smallest gap is open. Precondition: vertices are finite.
std::vector<bool> closed_parts(const MeshData& mesh);

}  // namespace rehearse
