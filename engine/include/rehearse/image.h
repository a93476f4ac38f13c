// Camera images, as the renderer draws them and controllers read them. Row 0 is the top row. C++17.
#pragma once

#include <cstdint>
#include <vector>

namespace rehearse {

/// A colour image: three bytes per pixel (red, green, blue), rows from the top, no padding.
struct Image {
  int width = 0;                     // [pixels]
  int height = 0;                    // [pixels]
  std::vector<std::uint8_t> pixels;  // width * height * 3
  std::vector<std::uint8_t> file{};  // the JPEG or PNG from which the pixels were decoded; empty: none
};

/// Distance along the camera's optical axis [m] for each pixel, rows from the top; +inf where there is no surface.
struct DepthImage {
  int width = 0;              // [pixels]
  int height = 0;             // [pixels]
  std::vector<float> meters;  // width * height
};

/// Rounds distances to the resolution of a depth camera: 13 significant bits, an error of at most 1/16384 of the
/// distance (at 1 m: 0.06 mm). The lower bits come from the rasteriser, not from the scene, and would make up most of
/// a recording.
void round_to_resolution(DepthImage& depth);

}  // namespace rehearse
