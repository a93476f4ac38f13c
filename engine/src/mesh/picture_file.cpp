#define XXH_INLINE_ALL
#include "picture_file.h"

#include <fmt/format.h>
#include <png.h>
#include <xxhash.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>

#include "mesh_input.h"
#include "picture/picture.h"

namespace rehearse {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::optional<Diagnostic> wrong_size(unsigned width, unsigned height) {
  if (width > 0 && height > 0 && width <= max_picture_side && height <= max_picture_side) return std::nullopt;
  return error(fmt::format("it is {} x {} pixels", width, height),
               fmt::format("at most {0} x {0} are read", max_picture_side));
}

Texture empty_texture(unsigned width, unsigned height) {
  return {static_cast<int>(width), static_cast<int>(height), std::vector<std::uint8_t>(std::size_t{4} * width * height),
          ""};
}

/// libpng's reader; its destructor frees it.
struct PngReader {
  png_image image{};
  PngReader() { image.version = PNG_IMAGE_VERSION; }
  ~PngReader() { png_image_free(&image); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

Result<Texture> decode_png_texture(std::string_view bytes) {
  PngReader reader;
  png_image& image = reader.image;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) return error(image.message);
  if (auto problem = wrong_size(image.width, image.height)) return *problem;
  image.format = PNG_FORMAT_RGBA;
  Texture texture = empty_texture(image.width, image.height);
  if (!png_image_finish_read(&image, nullptr, texture.rgba.data(), 0, nullptr)) return error(image.message);
  return texture;
}

Result<Texture> decode_jpeg_texture(std::string_view bytes) {
  const Image image = REHEARSE_TRY(decode_jpeg(bytes_of(bytes)));
  Texture texture = empty_texture(image.width, image.height);
  for (std::size_t pixel = 0; pixel < texture.rgba.size() / 4; ++pixel) {
    std::copy_n(&image.pixels[3 * pixel], 3, &texture.rgba[4 * pixel]);
    texture.rgba[4 * pixel + 3] = 255;
  }
  return texture;
}

}  // namespace

Result<Texture> decode_texture(std::string_view bytes) {
  if (is_png(bytes_of(bytes))) return decode_png_texture(bytes);
  if (is_jpeg(bytes_of(bytes))) return decode_jpeg_texture(bytes);
  if (bytes.starts_with("version https://git-lfs")) {
    return error("it is a git-lfs pointer, not the picture it stands for", "run: git lfs pull");
  }
  return error("it is neither PNG nor JPEG", "save it as one of them");
}

Result<Texture> read_picture(const std::filesystem::path& file, const std::string& name) {
  const std::string bytes = REHEARSE_TRY(read_mesh_file(file));
  Result<Texture> texture = decode_texture(bytes);
  if (!texture) return texture;
  texture->file = name;
  texture->digest = fmt::format("{:016x}", XXH3_64bits(bytes.data(), bytes.size()));
  return texture;
}

}  // namespace rehearse
