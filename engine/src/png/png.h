// PNG files in memory, lossless, the same bytes for the same pixels (as long as libdeflate's version is the same).
//
// A library of its own, Rehearse::png: whoever reads pictures need not be able to draw them.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rehearse {

/// The image, of at least one pixel, as a PNG file: with a palette if it has at most 256 colours, else 8-bit RGB. Fast
/// rather than smallest: at most about 1 ms for 640x480.
std::vector<std::uint8_t> encode_png(const Image& image);

/// Any PNG of up to 8 bits a sample (grey, RGB, palette, with or without alpha) as RGB; alpha is dropped.
/// Fails, with the decoder's own words where it has some, on what isn't a complete PNG file with right checksums, has
/// 16 bits a sample, or is wider or higher than 8192 pixels.
Result<Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace rehearse
