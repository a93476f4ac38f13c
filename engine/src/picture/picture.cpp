#include "picture.h"

#include <algorithm>
#include <array>

#include "jpeg.h"

namespace rehearse {
namespace {

constexpr std::array<std::uint8_t, 4> png_begin{0x89, 'P', 'N', 'G'};
constexpr std::array<std::uint8_t, 2> jpeg_begin{0xff, 0xd8};

bool begins_with(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> begin) {
  return bytes.size() >= begin.size() && std::equal(begin.begin(), begin.end(), bytes.begin());
}

}  // namespace

bool is_png(std::span<const std::uint8_t> bytes) { return begins_with(bytes, png_begin); }
bool is_jpeg(std::span<const std::uint8_t> bytes) { return begins_with(bytes, jpeg_begin); }

std::pair<int, int> size_of_picture(std::span<const std::uint8_t> bytes) {
  if (is_jpeg(bytes)) return jpeg_size(bytes);
  constexpr std::size_t width_at = 16, height_at = 20;  // in a PNG
  if (!is_png(bytes) || bytes.size() < height_at + 4) return {0, 0};
  const auto number = [&](std::size_t at) {
    return bytes[at] << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3];
  };
  return {number(width_at), number(height_at)};
}

Result<Image> decode_picture(std::span<const std::uint8_t> bytes) {
  if (is_png(bytes)) return decode_png(bytes);
  if (is_jpeg(bytes)) return decode_jpeg(bytes);
  return error("it is neither PNG nor JPEG", "save it as one of them");
}

}  // namespace rehearse
