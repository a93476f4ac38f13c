#include "recorded_picture.h"

#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "picture/picture.h"

namespace rehearse {
namespace {

std::optional<RecordedPicture> read_compressed(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::CompressedImage message;
  if (!msg::decode(reader, message)) return std::nullopt;
  RecordedPicture picture;
  picture.stamp = message.header.stamp.to_ns();
  if (message.data.empty()) return picture;  // the camera was off
  auto image = decode_picture(message.data);
  if (!image) return std::nullopt;
  picture.width = image->width;
  picture.height = image->height;
  picture.colors = std::move(image->pixels);
  return picture;
}

std::optional<RecordedPicture> read_raw(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::Image message;
  if (!msg::decode(reader, message)) return std::nullopt;
  RecordedPicture picture;
  picture.stamp = message.header.stamp.to_ns();
  picture.width = static_cast<int>(message.width);
  picture.height = static_cast<int>(message.height);
  if (message.encoding == "32FC1" && message.data.size() == picture.pixels() * sizeof(float)) {
    picture.depths.resize(picture.pixels());
    std::memcpy(picture.depths.data(), message.data.data(), message.data.size());
    return picture;
  }
  if (message.encoding != "rgb8" || message.data.size() != picture.pixels() * 3) return std::nullopt;
  picture.colors = std::move(message.data);
  return picture;
}

void compare_colors(const RecordedPicture& golden, const RecordedPicture& actual, double delta,
                    PixelDifferences& found) {
  for (std::size_t i = 0; i < found.states.size(); ++i) {
    int most = 0;
    for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
      most = std::max(most, std::abs(golden.colors[c] - actual.colors[c]));
    if (most > 0) found.states[i] = most > delta ? PixelState::beyond : PixelState::within;
    found.largest = std::max(found.largest, static_cast<double>(most));
  }
}

void compare_depths(const RecordedPicture& golden, const RecordedPicture& actual, const Tolerance& tolerance,
                    PixelDifferences& found) {
  for (std::size_t i = 0; i < found.states.size(); ++i) {
    const double expected = golden.depths[i], measured = actual.depths[i];
    if (expected == measured || (std::isnan(expected) && std::isnan(measured))) continue;
    const double difference = std::abs(expected - measured);
    const bool passes = std::isfinite(difference) && difference <= tolerance.bound(std::abs(expected));
    found.states[i] = passes ? PixelState::within : PixelState::beyond;
    found.largest = std::max(found.largest, difference);
  }
}

/// Counts the pixels beyond in every square, by sums over all pixels above and to the left.
void find_densest(int width, int height, PixelDifferences& found) {
  const int wide = std::min(width, PixelDifferences::window), high = std::min(height, PixelDifferences::window);
  const std::size_t stride = static_cast<std::size_t>(width) + 1;
  std::vector<std::uint32_t> sums(stride * (static_cast<std::size_t>(height) + 1));
  const auto sum = [&](int x, int y) -> std::uint32_t& {
    return sums[static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x)];
  };
  std::uint32_t most = 0;
  std::size_t pixel = 0;
  for (int y = 1; y <= height; ++y) {
    for (int x = 1; x <= width; ++x, ++pixel) {
      const std::uint32_t here = found.states[pixel] == PixelState::beyond ? 1 : 0;
      sum(x, y) = here + sum(x - 1, y) + sum(x, y - 1) - sum(x - 1, y - 1);
      if (x < wide || y < high) continue;
      const std::uint32_t count = sum(x, y) - sum(x - wide, y) - sum(x, y - high) + sum(x - wide, y - high);
      if (count <= most) continue;
      most = count;
      found.densest_x = x - wide;
      found.densest_y = y - high;
    }
  }
  found.densest = static_cast<double>(most) / (static_cast<double>(wide) * high);
}

}  // namespace

bool RecordedPicture::same_size(const RecordedPicture& other) const {
  return width == other.width && height == other.height && colors.size() == other.colors.size() &&
         depths.size() == other.depths.size();
}

std::optional<RecordedPicture> read_picture(std::string_view message_type, std::span<const std::byte> payload) {
  return message_type == msg::CompressedImage::type_name ? read_compressed(payload) : read_raw(payload);
}

PixelDifferences pixel_differences(const RecordedPicture& golden, const RecordedPicture& actual,
                                   const Tolerance& tolerance) {
  REHEARSE_ASSERT(golden.same_size(actual), "only pictures of the same size have differences pixel by pixel");
  PixelDifferences found;
  found.states.resize(golden.pixels(), PixelState::same);
  if (golden.depths.empty())
    compare_colors(golden, actual, tolerance.pixel_delta, found);
  else
    compare_depths(golden, actual, tolerance, found);
  for (const PixelState state : found.states) {
    if (state != PixelState::same) ++found.differing;
    if (state == PixelState::beyond) ++found.beyond;
  }
  if (found.beyond > 0) find_densest(golden.width, golden.height, found);
  return found;
}

}  // namespace rehearse
