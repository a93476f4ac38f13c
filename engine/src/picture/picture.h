// Picture files in memory: PNG and JPEG.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace rehearse {

/// Larger pictures aren't decoded: a small file could require gigabytes. [pixels], width and height
inline constexpr std::uint32_t max_picture_side = 8192;

/// Encodes an image of at least one pixel as a PNG file, lossless: with a palette if it has at most 256 colours, else
/// 8-bit RGB. Optimised for speed, not for size: at most about 1 ms for 640x480. The same pixels give the same bytes,
/// as long as libdeflate's version is the same.
std::vector<std::uint8_t> encode_png(const Image& image);

/// Decodes a PNG of up to 8 bits per sample (grey, RGB, palette, with or without alpha) to RGB; alpha is dropped.
/// Fails if the bytes aren't a complete PNG file with correct checksums, if it has 16 bits per sample, or is wider or
/// higher than max_picture_side. The error contains the decoder's message if there is one.
Result<Image> decode_png(std::span<const std::uint8_t> bytes);

/// Decodes a JPEG to RGB, with the same pixels on every processor. Fails if the bytes aren't a complete JPEG file, if
/// it is damaged, or wider or higher than max_picture_side. The error contains the decoder's message if there is one.
Result<Image> decode_jpeg(std::span<const std::uint8_t> bytes);

bool is_png(std::span<const std::uint8_t> bytes);
bool is_jpeg(std::span<const std::uint8_t> bytes);

/// Width and height [pixels] as the header of a PNG or JPEG states them; zeros for other bytes.
std::pair<int, int> size_of_picture(std::span<const std::uint8_t> bytes);

/// Decodes a PNG or a JPEG; the first bytes determine the format. Fails for other bytes.
Result<Image> decode_picture(std::span<const std::uint8_t> bytes);

}  // namespace rehearse
