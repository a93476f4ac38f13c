#include "picture_file.h"

#include <fmt/format.h>
#include <png.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>

namespace rehearse {
namespace {

/// The memory layout of an encoding of sensor_msgs/Image, and its form in PNG.
struct PixelForm {
  std::string_view encoding;
  int channels = 1;
  int bytes = 1;  // bytes per channel
  int color_type = PNG_COLOR_TYPE_GRAY;
  bool is_bgr = false;
  bool is_distance = false;  // float32 [m]
};
constexpr std::array<PixelForm, 11> pixel_forms{{{"rgb8", 3, 1, PNG_COLOR_TYPE_RGB},
                                                 {"8UC3", 3, 1, PNG_COLOR_TYPE_RGB, true},
                                                 {"bgr8", 3, 1, PNG_COLOR_TYPE_RGB, true},
                                                 {"rgba8", 4, 1, PNG_COLOR_TYPE_RGB_ALPHA},
                                                 {"8UC4", 4, 1, PNG_COLOR_TYPE_RGB_ALPHA, true},
                                                 {"bgra8", 4, 1, PNG_COLOR_TYPE_RGB_ALPHA, true},
                                                 {"mono8", 1, 1, PNG_COLOR_TYPE_GRAY},
                                                 {"8UC1", 1, 1, PNG_COLOR_TYPE_GRAY},
                                                 {"mono16", 1, 2, PNG_COLOR_TYPE_GRAY},
                                                 {"16UC1", 1, 2, PNG_COLOR_TYPE_GRAY},
                                                 {"32FC1", 1, 4, PNG_COLOR_TYPE_GRAY, false, true}}};

constexpr std::uint32_t largest_side = 65'535;  // [pixels]

/// The distance in 16 bits [mm], as ROS represents it.
std::uint16_t millimetres(float metres) {
  const double scaled = std::round(static_cast<double>(metres) * 1000.0);
  if (!std::isfinite(metres) || scaled <= 0.0) return 0;
  return static_cast<std::uint16_t>(std::min(scaled, 65'535.0));
}

/// Converts a row to PNG's form: samples of more than a byte are big-endian.
void convert_row(const PixelForm& form, bool is_big_endian, std::span<const std::uint8_t> from,
                 std::vector<std::uint8_t>& to) {
  if (form.is_distance) {
    to.resize(from.size() / 2);
    for (std::size_t i = 0; i < from.size() / 4; ++i) {
      std::array<std::uint8_t, 4> bytes;
      std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(4 * i), 4, bytes.begin());
      if (is_big_endian) std::ranges::reverse(bytes);
      const std::uint16_t value = millimetres(std::bit_cast<float>(bytes));
      to[2 * i] = static_cast<std::uint8_t>(value >> 8);
      to[2 * i + 1] = static_cast<std::uint8_t>(value & 0xff);
    }
    return;
  }
  to.assign(from.begin(), from.end());
  if (form.bytes == 2 && !is_big_endian) {
    for (std::size_t i = 0; i + 1 < to.size(); i += 2) std::swap(to[i], to[i + 1]);
  }
  if (form.is_bgr) {
    const auto step = static_cast<std::size_t>(form.channels);
    for (std::size_t i = 0; i + step <= to.size(); i += step) std::swap(to[i], to[i + 2]);
  }
}

void append(png_structp png, png_bytep bytes, png_size_t size) {
  auto& file = *static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  file.insert(file.end(), bytes, bytes + size);
}

/// Suppresses messages of libpng on stderr; errors are returned.
void stay_silent(png_structp, png_const_charp) {}

/// No object here has a destructor, because libpng leaves by longjmp. False after an error.
bool write_png(png_structp png, png_infop info, const msg::Image& image, const PixelForm& form,
               std::vector<std::uint8_t>& row) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_compression_level(png, 3);
  png_set_IHDR(png, info, image.width, image.height, form.bytes == 1 ? 8 : 16, form.color_type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  const std::size_t used = std::size_t{image.width} * static_cast<std::size_t>(form.channels * form.bytes);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    convert_row(form, image.is_bigendian != 0, std::span(image.data).subspan(std::size_t{y} * image.step, used), row);
    png_write_row(png, row.data());
  }
  png_write_end(png, info);
  return true;
}

Result<PictureFile> from_image(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::Image image;
  if (!msg::decode(reader, image)) return error("a message is no sensor_msgs/msg/Image");
  PictureFile picture;
  picture.stamp = image.header.stamp.to_ns();
  if (image.width == 0 || image.height == 0) return picture;
  const auto form =
      std::ranges::find_if(pixel_forms, [&](const PixelForm& known) { return known.encoding == image.encoding; });
  if (form == pixel_forms.end())
    return error(fmt::format("pictures of encoding '{}' can't be written", image.encoding));
  const std::uint64_t used = std::uint64_t{image.width} * static_cast<std::uint64_t>(form->channels * form->bytes);
  if (image.width > largest_side || image.height > largest_side || image.step < used ||
      image.data.size() < std::uint64_t{image.step} * (image.height - 1) + used) {
    return error(fmt::format("a picture states {} x {} pixels of {} in rows of {} bytes, but has {} bytes", image.width,
                             image.height, image.encoding, image.step, image.data.size()));
  }
  std::vector<std::uint8_t> row;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, stay_silent);
  png_infop info = png_create_info_struct(png);
  REHEARSE_ASSERT(info != nullptr, "libpng has memory");
  png_set_write_fn(png, &picture.bytes, append, nullptr);
  const bool written = write_png(png, info, image, *form, row);
  png_destroy_write_struct(&png, &info);
  if (!written) return error("libpng can't write a picture");
  picture.extension = "png";
  return picture;
}

Result<PictureFile> from_compressed(std::span<const std::byte> payload) {
  CdrReader reader(payload);
  msg::CompressedImage image;
  if (!msg::decode(reader, image)) return error("a message is no sensor_msgs/msg/CompressedImage");
  PictureFile picture;
  picture.stamp = image.header.stamp.to_ns();
  if (image.data.empty()) return picture;
  // The format is detected from the bytes, because the text of `format` differs between writers.
  const std::string_view begin(reinterpret_cast<const char*>(image.data.data()), image.data.size());
  if (begin.starts_with("\x89PNG\r\n\x1a\n")) picture.extension = "png";
  if (begin.starts_with("\xff\xd8\xff")) picture.extension = "jpg";
  if (picture.extension.empty())
    return error(fmt::format("a picture of format '{}' is neither PNG nor JPEG", image.format));
  picture.bytes = std::move(image.data);
  return picture;
}

}  // namespace

bool is_picture_type(std::string_view message_type) {
  return message_type == msg::Image::type_name || message_type == msg::CompressedImage::type_name;
}

Result<PictureFile> picture_file(std::string_view message_type, std::span<const std::byte> payload) {
  return message_type == msg::Image::type_name ? from_image(payload) : from_compressed(payload);
}

}  // namespace rehearse
