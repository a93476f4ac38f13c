// PNG without compression: enough for Image::save, without a library on which every controller would then depend.
#pragma once

#include <string>
#include <vector>

namespace cnoid {

/// The bytes of a PNG file. `components`: 1 gray, 2 gray and opacity, 3 RGB, 4 RGBA, eight bits each; `pixels`:
/// height * width * components bytes, top row first. Format: PNG specification (W3C), deflate's stored blocks (RFC
/// 1951).
std::string encodePng(int width, int height, int components, const std::vector<unsigned char>& pixels);

}  // namespace cnoid
