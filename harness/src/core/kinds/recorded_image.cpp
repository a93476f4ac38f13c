#include "recorded_image.h"

#include <rehearse/cdr.h>

#include <string>
#include <utility>

#include "base/hashing.h"
#include "picture/picture.h"

namespace rehearse {
namespace {

// The first part as in ROS 2's image_transport.
constexpr const char* png_format = "rgb8; png compressed";
constexpr const char* jpeg_format = "rgb8; jpeg compressed bgr8; pixels ";

std::string jpeg_format_of(const Image& image) {
  return jpeg_format + hash_text(hash_bytes(image.pixels.data(), image.pixels.size()));
}

/// A picture that isn't encoded so far.
struct RawPicture {
  static constexpr std::string_view type_name = "RawPicture";
  msg::Header header;
  std::int32_t width = 0, height = 0;
  std::vector<std::uint8_t> pixels, file;
  REHEARSE_FIELDS(header, width, height, pixels, file)
};

template <class Message>
std::vector<std::byte> cdr_of(const Message& message) {
  CdrWriter cdr;
  msg::encode(message, cdr);
  return {cdr.bytes().begin(), cdr.bytes().end()};
}

}  // namespace

std::vector<std::byte> raw_picture(const msg::Header& header, const Image& image) {
  return cdr_of(RawPicture{header, image.width, image.height, image.pixels, image.file});
}

std::vector<std::byte> compose_picture(std::span<const std::byte> raw) {
  CdrReader reader(raw);
  RawPicture picture;
  REHEARSE_ASSERT(msg::decode(reader, picture), "raw_picture() made these bytes");
  return cdr_of(
      message_of(picture.header, {picture.width, picture.height, std::move(picture.pixels), std::move(picture.file)}));
}

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
