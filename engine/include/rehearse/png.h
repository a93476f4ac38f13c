// PNG files in memory, lossless, the same bytes for the same pixels.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/image.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rehearse {

/// The image as a PNG file, 8-bit RGB. Fast rather than smallest.
std::vector<std::uint8_t> encode_png(const Image& image);

/// Any 8-bit PNG (grey, RGB, RGBA, palette) as RGB; alpha is dropped. Fails with the decoder's own words.
Result<Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace rehearse
