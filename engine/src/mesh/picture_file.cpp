#define XXH_INLINE_ALL
#include "picture_file.h"

#include <fmt/format.h>
#include <png.h>
#include <xxhash.h>

#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>

#include <jpeglib.h>  // needs size_t and FILE from the headers above

#include "mesh_input.h"

namespace rehearse {
namespace {

std::optional<Diagnostic> wrong_size(unsigned width, unsigned height) {
  if (width > 0 && height > 0 && width <= max_texture_side && height <= max_texture_side) return std::nullopt;
  return error(fmt::format("it is {} x {} pixels", width, height),
               fmt::format("at most {0} x {0} are read", max_texture_side));
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

/// By default libjpeg ends the process at an error. Here it jumps back to decode(), over C code only.
class JpegReader {
 public:
  explicit JpegReader(std::string_view bytes) : bytes_(bytes) {
    info_.err = jpeg_std_error(&errors_);
    errors_.error_exit = [](j_common_ptr info) {
      auto& self = *static_cast<JpegReader*>(info->client_data);
      info->err->format_message(info, self.message_);
      std::longjmp(self.back_, 1);
    };
    errors_.emit_message = [](j_common_ptr info, int level) {
      if (level >= 0) return;  // a trace message, not a warning
      if (info->err->num_warnings++ == 0)
        info->err->format_message(info, static_cast<JpegReader*>(info->client_data)->message_);
    };
    info_.client_data = this;
  }
  ~JpegReader() { jpeg_destroy_decompress(&info_); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  /// Reads width and height. False: see message().
  bool begin() {
    if (setjmp(back_) != 0) return false;
    jpeg_create_decompress(&info_);
    info_.client_data = this;
    jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes_.data()), bytes_.size());
    return jpeg_read_header(&info_, TRUE) == JPEG_HEADER_OK;
  }

  /// Reads the pixels. False: see message(). libjpeg continues after damaged data and fills with grey; here that is a
  /// failure. The integer transform gives the same pixels on every processor, with and without SIMD (libjpeg-turbo's
  /// manual, on JDCT_ISLOW).
  bool finish(std::uint8_t* rgba) {
    if (setjmp(back_) != 0) return false;
    info_.out_color_space = JCS_EXT_RGBA;
    info_.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&info_);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = rgba + std::size_t{4} * info_.output_width * info_.output_scanline;
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return errors_.num_warnings == 0;
  }

  unsigned width() const { return info_.image_width; }
  unsigned height() const { return info_.image_height; }
  std::string message() const { return message_; }

 private:
  std::string_view bytes_;
  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf back_{};
  char message_[JMSG_LENGTH_MAX] = "";
};

Result<Texture> decode_jpeg_texture(std::string_view bytes) {
  const auto reader = std::make_unique<JpegReader>(bytes);
  if (!reader->begin()) return error(reader->message());
  if (auto problem = wrong_size(reader->width(), reader->height())) return *problem;
  Texture texture = empty_texture(reader->width(), reader->height());
  if (!reader->finish(texture.rgba.data())) return error(reader->message());
  return texture;
}

}  // namespace

Result<Texture> decode_picture(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return decode_png_texture(bytes);
  if (bytes.starts_with("\xFF\xD8")) return decode_jpeg_texture(bytes);
  if (bytes.starts_with("version https://git-lfs")) {
    return error("it is a git-lfs pointer, not the picture it stands for", "run: git lfs pull");
  }
  return error("it is neither PNG nor JPEG", "save it as one of them");
}

Result<Texture> read_picture(const std::filesystem::path& file, const std::string& name) {
  const Result<std::string> bytes = read_mesh_file(file);
  if (!bytes) return bytes.errors();
  Result<Texture> texture = decode_picture(*bytes);
  if (!texture) return texture;
  texture->file = name;
  texture->digest = fmt::format("{:016x}", XXH3_64bits(bytes->data(), bytes->size()));
  return texture;
}

}  // namespace rehearse
