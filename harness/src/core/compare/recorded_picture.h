// RecordedPicture: a camera's picture from a recording, and the differences of two pictures pixel by pixel.
#pragma once

#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace rehearse {

/// Colours or distances; one of both, or none if the camera was off.
struct RecordedPicture {
  std::uint64_t stamp = 0;  // when it was captured [ns]
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> colors;  // three a pixel
  std::vector<float> depths;         // one a pixel [m]

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
  bool same_size(const RecordedPicture& other) const;
};

/// From the bytes of a CompressedImage (PNG or JPEG) or an Image (rgb8, 32FC1); nullopt for other bytes.
std::optional<RecordedPicture> read_picture(std::string_view message_type, std::span<const std::byte> payload);

enum class PixelState : std::uint8_t { same, within, beyond };  // beyond: by more than a pixel's tolerance

struct PixelDifferences {
  static constexpr int window = 16;  // side of the examined squares [pixels]

  std::vector<PixelState> states;  // one a pixel
  std::size_t differing = 0;       // pixels, those beyond included
  std::size_t beyond = 0;          // pixels
  double largest = 0.0;            // difference [of 255] or [m]
  double densest = 0.0;            // largest share of pixels beyond in any square
  int densest_x = 0;               // upper left corner of that square
  int densest_y = 0;

  double share() const {
    return states.empty() ? 0.0 : static_cast<double>(beyond) / static_cast<double>(states.size());
  }
};

/// Compares two pictures of the same size. A colour may differ by pixel_delta, a distance by the tolerance at the
/// expected distance. If only one picture has a distance, a silhouette has moved: the pixel is beyond any tolerance.
PixelDifferences pixel_differences(const RecordedPicture& golden, const RecordedPicture& actual,
                                   const Tolerance& tolerance);

}  // namespace rehearse
