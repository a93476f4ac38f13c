// A recorded picture as a file for other programs. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

struct PictureFile {
  std::uint64_t stamp = 0;          // time of its capture [ns]
  std::string extension;            // "png", "jpg"; empty: the camera was off
  std::vector<std::uint8_t> bytes;  // bytes of the file
};

bool is_picture_type(std::string_view message_type);

/// Makes the file from the payload of a CompressedImage or an Image. Fails for other types, or for an encoding that PNG
/// can't represent.
Result<PictureFile> picture_file(std::string_view message_type, std::span<const std::byte> payload);

}  // namespace rehearse
