// Converts pictures in ROS messages to Image and DepthImage.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/messages.h>

namespace rehearse {

/// From encodings rgb8, bgr8, rgba8, bgra8 (alpha is dropped) and mono8. Fails on others, and on data that is too
/// short.
Result<Image> color_of(const msg::Image& message);

/// From JPEG or PNG, detected by its first bytes. Fails on other formats and on damaged data.
Result<Image> color_of(const msg::CompressedImage& message);

/// From encodings 32FC1 [m] and 16UC1 [mm]; 0 and NaN are no distance and become +inf.
Result<DepthImage> depth_of(const msg::Image& message);

}  // namespace rehearse
