// Pixels: what a camera draws and a controller reads. Row 0 is the top row. C++17.
#pragma once

#include <cstdint>
#include <vector>

namespace rehearse {

/// Colour, three bytes a pixel (red, green, blue), rows from the top, no padding.
struct Image {
  int width = 0;                       // [pixels]
  int height = 0;                      // [pixels]
  std::vector<std::uint8_t> pixels;    // width * height * 3
};

/// Distance along the camera's optical axis [m] for each pixel, rows from the top; +inf where nothing was hit.
struct DepthImage {
  int width = 0;                       // [pixels]
  int height = 0;                      // [pixels]
  std::vector<float> meters;           // width * height
};

/// Brings distances to what a depth camera resolves: 13 significant bits, an error of at most 1/16384 of the distance
/// (at 1 m: 0.06 mm). The bits behind them are the rasteriser's, not the scene's, and would make up most of a
/// recording.
void round_to_resolution(DepthImage& depth);

}  // namespace rehearse
