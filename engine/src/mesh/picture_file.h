// Pictures as files, for the textures of meshes.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <string_view>

namespace rehearse {

inline constexpr unsigned max_texture_side = 8192;  // [pixels]

/// Decodes a PNG or a JPEG, told by their first bytes. A damaged or truncated one is an error. The result's `file` is
/// empty.
Result<Texture> decode_picture(std::string_view bytes);

}  // namespace rehearse
