// Decodes picture files, for the textures of meshes.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <string_view>

namespace rehearse {

inline constexpr unsigned max_texture_side = 8192;  // [pixels]

/// Decodes a PNG or a JPEG; the first bytes determine the format. A damaged or truncated file is an error. The result's
/// `file` is empty.
Result<Texture> decode_picture(std::string_view bytes);

}  // namespace rehearse
