// The encoder is a small piece of code around libdeflate, because encoding a camera's frame must take less time than
// drawing it. The decoder is libpng, because it must read the files of all programs.
#include "picture.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <png.h>

#include <array>
#include <cstring>
#include <memory>
#include <string_view>

namespace rehearse {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Measured on a rendered scene of 640x480 (20 shapes on a floor; drawing it takes 5.1 ms, one core of 2020):
//   level 1, unfiltered  0.95 ms  32 kB        level 2, filter Up  1.39 ms  27 kB
//   level 1, filter Up   2.25 ms  27 kB        level 6, filter Up  1.76 ms  24 kB
// Rendered surfaces are nearly even, so the filters gain little; at level 1 they even prevent the search for long runs.
// For textured meshes on a checkered floor, up close (201 kB, 2.6 ms), Sub gains 13 % for 0.5 ms, and Paeth no more in
// three times the time. The raw pixels through zstd are 20 % larger at level 1, in less than half the time. But every
// tool shows a PNG, and encoding runs on the trace's separate thread.
constexpr int compression_level = 1;
constexpr std::uint8_t unfiltered = 0;

void append_u32(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// A chunk: length, type, content, CRC of type and content.
void append_chunk(Bytes& file, std::string_view type, std::span<const std::uint8_t> content) {
  append_u32(file, static_cast<std::uint32_t>(content.size()));
  const std::size_t checked_from = file.size();
  file.insert(file.end(), type.begin(), type.end());
  file.insert(file.end(), content.begin(), content.end());
  append_u32(file, libdeflate_crc32(0, file.data() + checked_from, file.size() - checked_from));
}

enum class PixelKind : std::uint8_t { rgb = 2, palette = 3 };

Bytes header_of(const Image& image, PixelKind kind, int bits_per_sample) {
  Bytes header;
  append_u32(header, static_cast<std::uint32_t>(image.width));
  append_u32(header, static_cast<std::uint32_t>(image.height));
  constexpr std::uint8_t deflate = 0, adaptive_filters = 0, not_interlaced = 0;
  header.insert(header.end(), {static_cast<std::uint8_t>(bits_per_sample), static_cast<std::uint8_t>(kind), deflate,
                               adaptive_filters, not_interlaced});
  return header;
}

/// Numbers colours in the order of their first appearance, as long as there are at most 256.
class Palette {
 public:
  /// The colour's number, or -1 if there are too many colours.
  int number_of(const std::uint8_t* color) {
    const std::uint32_t key = (std::uint32_t{color[0]} << 16 | std::uint32_t{color[1]} << 8 | color[2]) + 1;
    std::size_t slot = (key * 0x9e3779b1u) >> 23;
    while (keys_[slot] != 0 && keys_[slot] != key) slot = (slot + 1) % keys_.size();
    if (keys_[slot] == key) return numbers_[slot];
    if (colors_.size() == max_colors * 3) return -1;
    keys_[slot] = key;
    numbers_[slot] = static_cast<std::uint8_t>(colors_.size() / 3);
    colors_.insert(colors_.end(), color, color + 3);
    return numbers_[slot];
  }
  /// The palette, three bytes per colour.
  const Bytes& colors() const { return colors_; }

 private:
  static constexpr std::size_t max_colors = 256;
  std::array<std::uint32_t, 512> keys_{};  // a colour and 1; 0: unused
  std::array<std::uint8_t, 512> numbers_{};
  Bytes colors_;
};

/// A picture as numbers of a palette. In a camera's pictures most pixels and rows equal the one before.
struct IndexedImage {
  Palette palette;
  Bytes distinct;                   // one byte per pixel; rows that differ from the row above them
  std::vector<std::size_t> offset;  // of each row of the picture in `distinct`

  /// False if there are too many colours.
  bool read(const Image& image) {
    const auto row_size = static_cast<std::size_t>(image.width) * 3;
    for (std::size_t at = 0; at < image.pixels.size(); at += row_size) {
      const std::uint8_t* row = &image.pixels[at];
      if (at > 0 && std::memcmp(row, row - row_size, row_size) == 0) {
        offset.push_back(offset.back());
        continue;
      }
      offset.push_back(distinct.size());
      distinct.resize(distinct.size() + row_size / 3);
      std::uint8_t* place = &distinct[offset.back()];
      int number = -1;
      for (const std::uint8_t* pixel = row; pixel != row + row_size; pixel += 3) {
        if (pixel == row || std::memcmp(pixel, pixel - 3, 3) != 0) number = palette.number_of(pixel);
        if (number < 0) return false;
        *place++ = static_cast<std::uint8_t>(number);
      }
    }
    return true;
  }

  /// Bits per pixel: the smallest number that PNG allows and that is enough for every colour number.
  int bits_per_pixel() const {
    const std::size_t colors = palette.colors().size() / 3;
    return colors <= 2 ? 1 : colors <= 4 ? 2 : colors <= 16 ? 4 : 8;
  }

  /// The rows in PNG's form: each after its filter byte, the first pixel of a byte in its highest bits.
  Bytes rows(std::size_t width) const {
    const auto bits = static_cast<std::size_t>(bits_per_pixel());
    const std::size_t row_size = 1 + (width * bits + 7) / 8;
    Bytes rows;
    rows.reserve(row_size * offset.size());
    for (std::size_t y = 0; y < offset.size(); ++y) {
      const std::size_t at = rows.size();
      rows.resize(at + row_size, 0);
      if (y > 0 && offset[y] == offset[y - 1]) {
        std::memcpy(&rows[at], &rows[at - row_size], row_size);
        continue;
      }
      rows[at] = unfiltered;
      if (bits == 8) {
        std::memcpy(&rows[at + 1], &distinct[offset[y]], width);
        continue;
      }
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t bit = x * bits;
        rows[at + 1 + bit / 8] |= static_cast<std::uint8_t>(distinct[offset[y] + x] << (8 - bits - bit % 8));
      }
    }
    return rows;
  }
};

/// The rows in PNG's form: each after a byte that gives its filter.
Bytes rows_of(const Image& image) {
  const auto row_size = static_cast<std::ptrdiff_t>(image.width) * 3;
  Bytes rows;
  rows.reserve(image.pixels.size() + static_cast<std::size_t>(image.height));
  for (auto row = image.pixels.begin(); row != image.pixels.end(); row += row_size) {
    rows.push_back(unfiltered);
    rows.insert(rows.end(), row, row + row_size);
  }
  return rows;
}

Bytes compressed(const Bytes& bytes) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(compression_level), &libdeflate_free_compressor);
  REHEARSE_ASSERT(compressor, "no memory to compress a picture");
  Bytes packed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()));
  packed.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), packed.data(), packed.size()));
  REHEARSE_ASSERT(!packed.empty(), "a picture compresses to more than its bound");
  return packed;
}

/// libpng's reader; its destructor frees it.
struct Reader {
  png_image image{};
  Reader() { image.version = PNG_IMAGE_VERSION; }
  ~Reader() { png_image_free(&image); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
};

Diagnostic not_a_picture(const Reader& reader) {
  return error(fmt::format("can't decode PNG: {}", reader.image.message));
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image) {
  REHEARSE_ASSERT(image.width > 0 && image.height > 0, "a PNG has at least one pixel");
  REHEARSE_ASSERT(
      image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3,
      "an image has three bytes a pixel");
  Bytes file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  if (IndexedImage indexed; indexed.read(image)) {
    append_chunk(file, "IHDR", header_of(image, PixelKind::palette, indexed.bits_per_pixel()));
    append_chunk(file, "PLTE", indexed.palette.colors());
    append_chunk(file, "IDAT", compressed(indexed.rows(static_cast<std::size_t>(image.width))));
  } else {
    append_chunk(file, "IHDR", header_of(image, PixelKind::rgb, 8));
    append_chunk(file, "IDAT", compressed(rows_of(image)));
  }
  append_chunk(file, "IEND", {});
  return file;
}

Result<Image> decode_png(std::span<const std::uint8_t> bytes) {
  Reader reader;
  if (!png_image_begin_read_from_memory(&reader.image, bytes.data(), bytes.size())) return not_a_picture(reader);
  const png_image& head = reader.image;
  if (head.format & PNG_FORMAT_FLAG_LINEAR) {
    return error("can't decode PNG: it has 16 bits a sample", "8 bits a sample are read");
  }
  if (head.width > max_picture_side || head.height > max_picture_side) {
    return error(fmt::format("can't decode PNG: it is {} x {} pixels", head.width, head.height),
                 fmt::format("at most {0} x {0} are read", max_picture_side));
  }
  Image image{static_cast<int>(head.width), static_cast<int>(head.height), {}};
  if (!(head.format & PNG_FORMAT_FLAG_ALPHA)) {
    reader.image.format = PNG_FORMAT_RGB;
    image.pixels.resize(PNG_IMAGE_SIZE(reader.image));
    if (!png_image_finish_read(&reader.image, nullptr, image.pixels.data(), 0, nullptr)) return not_a_picture(reader);
    return image;
  }
  reader.image.format = PNG_FORMAT_RGBA;  // for RGB, libpng would blend with a background
  Bytes rgba(PNG_IMAGE_SIZE(reader.image));
  if (!png_image_finish_read(&reader.image, nullptr, rgba.data(), 0, nullptr)) return not_a_picture(reader);
  image.pixels.reserve(rgba.size() / 4 * 3);
  for (auto pixel = rgba.begin(); pixel != rgba.end(); pixel += 4) {
    image.pixels.insert(image.pixels.end(), pixel, pixel + 3);
  }
  return image;
}

}  // namespace rehearse
