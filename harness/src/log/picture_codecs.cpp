#include "picture_codecs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "picture/picture.h"

namespace rehearse {
namespace {

/// The places of the colours in a pixel.
struct ColorLayout {
  const char* encoding;
  std::size_t bytes;  // per pixel
  std::array<std::size_t, 3> rgb;
};
constexpr ColorLayout color_layouts[] = {{"rgb8", 3, {0, 1, 2}},
                                         {"bgr8", 3, {2, 1, 0}},
                                         {"rgba8", 4, {0, 1, 2}},
                                         {"bgra8", 4, {2, 1, 0}},
                                         {"mono8", 1, {0, 0, 0}}};

/// Fails unless the data has the size of all rows.
Result<void> check_size(const msg::Image& message, std::size_t pixel) {
  if (message.width == 0 || message.height == 0 || message.width > max_picture_side ||
      message.height > max_picture_side)
    return error(fmt::format("a picture of {} x {} pixels", message.width, message.height),
                 fmt::format("expected 1 to {} a side", max_picture_side));
  if (message.step < message.width * pixel || message.data.size() / message.step < message.height)
    return error(fmt::format("a picture of {} x {} pixels in {} has {} bytes, {} a row", message.width, message.height,
                             message.encoding, message.data.size(), message.step));
  return {};
}

/// The numbers of a row in the order of bytes of this machine.
template <class Number>
void read_row(const std::uint8_t* bytes, bool swap, std::vector<Number>& row) {
  std::memcpy(row.data(), bytes, row.size() * sizeof(Number));
  if (!swap) return;
  for (Number& number : row) {
    auto places = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(number);
    std::reverse(places.begin(), places.end());
    number = std::bit_cast<Number>(places);
  }
}

template <class Number>
Result<DepthImage> distances(const msg::Image& message, float meters) {
  if (auto fits = check_size(message, sizeof(Number)); !fits) return fits.errors();
  const bool swap = (message.is_bigendian != 0) != (std::endian::native == std::endian::big);
  DepthImage depth{static_cast<int>(message.width), static_cast<int>(message.height), {}};
  depth.meters.resize(std::size_t{message.width} * message.height);
  std::vector<Number> row(message.width);
  float* pixel = depth.meters.data();
  for (std::size_t y = 0; y < message.height; ++y) {
    read_row(&message.data[y * message.step], swap, row);
    for (const Number raw : row) {
      const float distance = static_cast<float>(raw) * meters;
      const bool is_none = std::isfinite(distance) && distance <= 0.0f;  // NaN and ±inf stay
      *pixel++ = is_none ? std::numeric_limits<float>::infinity() : distance;
    }
  }
  return depth;
}

}  // namespace

Result<Image> color_of(const msg::Image& message) {
  for (const ColorLayout& layout : color_layouts) {
    if (message.encoding != layout.encoding) continue;
    if (auto fits = check_size(message, layout.bytes); !fits) return fits.errors();
    Image image{static_cast<int>(message.width), static_cast<int>(message.height), {}};
    image.pixels.resize(std::size_t{message.width} * message.height * 3);
    std::uint8_t* color = image.pixels.data();
    for (std::size_t y = 0; y < message.height; ++y) {
      const std::uint8_t* pixel = &message.data[y * message.step];
      for (std::size_t x = 0; x < message.width; ++x, pixel += layout.bytes)
        for (const std::size_t at : layout.rgb) *color++ = pixel[at];
    }
    return image;
  }
  return error(fmt::format("a picture in '{}'", message.encoding), "read are rgb8, bgr8, rgba8, bgra8 and mono8");
}

Result<Image> color_of(const msg::CompressedImage& message) {
  if (is_png(message.data) || is_jpeg(message.data)) return decode_picture(message.data);
  return error(fmt::format("a picture in '{}', which is neither JPEG nor PNG", message.format),
               "read are JPEG and PNG");
}

Result<DepthImage> depth_of(const msg::Image& message) {
  if (message.encoding == "32FC1") return distances<float>(message, 1.0f);
  if (message.encoding == "16UC1" || message.encoding == "mono16") return distances<std::uint16_t>(message, 0.001f);
  return error(fmt::format("a depth picture in '{}'", message.encoding), "read are 32FC1 [m] and 16UC1 [mm]");
}

}  // namespace rehearse
