#include "recorded_image.h"

#include <string>
#include <utility>

#include "picture/picture.h"
#include "trace/hashing.h"

namespace rehearse {
namespace {

// The first part as in ROS 2's image_transport.
constexpr const char* png_format = "rgb8; png compressed";
constexpr const char* jpeg_format = "rgb8; jpeg compressed bgr8; pixels ";

std::string jpeg_format_of(const Image& image) {
  return jpeg_format + hash_text(hash_bytes(image.pixels.data(), image.pixels.size()));
}

}  // namespace

msg::CompressedImage message_of(const msg::Header& header, const Image& image) {
  if (image.file.empty()) return {header, png_format, encode_png(image)};
  return {header, is_jpeg(image.file) ? jpeg_format_of(image) : png_format, image.file};
}

Result<Image> image_of(msg::CompressedImage message) {
  Result<Image> image = decode_picture(message.data);
  if (!image) return image;
  if (message.format.starts_with(jpeg_format) && message.format != jpeg_format_of(*image))
    return error("the JPEG has other pixels on this machine than in the recorded run",
                 "replay it with the libjpeg of the recorded run");
  image->file = std::move(message.data);
  return image;
}

}  // namespace rehearse
