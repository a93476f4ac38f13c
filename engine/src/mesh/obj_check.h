// Checks an OBJ file, so that assimp drops no face of it.
#pragma once

#include <rehearse/diagnostic.h>

#include <string_view>

namespace rehearse {

/// Checks that each `v` has three numbers and each `f` at least three corners, and that each corner refers to existing
/// vertices, texture coordinates and normals. Else an error with its line. (assimp drops a face with fewer corners
/// without a message.)
Result<void> check_obj(std::string_view text);

}  // namespace rehearse
