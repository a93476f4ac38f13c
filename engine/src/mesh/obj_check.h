// What an OBJ's lines must hold so that nothing of it is lost.
#pragma once

#include <rehearse/diagnostic.h>

#include <string_view>

namespace rehearse {

/// Each `v` has three numbers, each `f` three corners or more, and each corner refers to vertices, texture coordinates
/// and normals that are there. assimp drops a face with fewer corners without a word. Else an error with its line.
Result<void> check_obj(std::string_view text);

}  // namespace rehearse
