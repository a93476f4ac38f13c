// The header of a JPEG.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

namespace rehearse {

/// Width and height [pixels]; zeros if the bytes aren't the header of a JPEG.
std::pair<int, int> jpeg_size(std::span<const std::uint8_t> bytes);

}  // namespace rehearse
