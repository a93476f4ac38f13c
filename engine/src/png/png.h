// PNG files in memory, lossless. The same pixels give the same bytes, as long as libdeflate's version is the same.
//
// A separate library, Rehearse::png, so that a program can read pictures without linking the renderer.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rehearse {

/// Encodes an image of at least one pixel as a PNG file: with a palette if it has at most 256 colours, else 8-bit RGB.
/// Optimised for speed, not for size: at most about 1 ms for 640x480.
std::vector<std::uint8_t> encode_png(const Image& image);

/// Decodes a PNG of up to 8 bits per sample (grey, RGB, palette, with or without alpha) to RGB; alpha is dropped.
/// Fails if the bytes aren't a complete PNG file with correct checksums, if it has 16 bits per sample, or is wider or
/// higher than 8192 pixels. The error contains the decoder's message if there is one.
Result<Image> decode_png(std::span<const std::uint8_t> bytes);

}  // namespace rehearse
