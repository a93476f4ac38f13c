// Decodes picture files, for the textures of meshes.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/model.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace rehearse {

/// Decodes a PNG or a JPEG; the first bytes determine the format. A damaged or truncated file is an error. The result's
/// `file` is empty.
Result<Texture> decode_texture(std::string_view bytes);

/// Reads a texture that a robot's file names: the picture with its digest. `name` is the result's `file`.
Result<Texture> read_picture(const std::filesystem::path& file, const std::string& name);

}  // namespace rehearse
