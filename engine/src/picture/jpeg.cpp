#include "jpeg.h"

#include <fmt/format.h>

#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <string>

#include <jpeglib.h>  // needs size_t and FILE from the headers above

#include "picture.h"

namespace rehearse {
namespace {

/// By default libjpeg ends the process at an error. Here it jumps back to begin() or finish(), over C code only.
class JpegReader {
 public:
  explicit JpegReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    info_.err = jpeg_std_error(&errors_);
    errors_.error_exit = [](j_common_ptr info) {
      auto& self = *static_cast<JpegReader*>(info->client_data);
      info->err->format_message(info, self.message_);
      std::longjmp(self.back_, 1);
    };
    // After damaged data libjpeg would continue and fill with grey. A level from 0 is a trace message.
    errors_.emit_message = [](j_common_ptr info, int level) {
      if (level < 0) info->err->error_exit(info);
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
    jpeg_mem_src(&info_, bytes_.data(), static_cast<unsigned long>(bytes_.size()));
    return jpeg_read_header(&info_, TRUE) == JPEG_HEADER_OK;
  }

  /// Reads the pixels. False: see message(). The integer transform gives the same pixels on every processor, with and
  /// without SIMD (libjpeg-turbo's manual, on JDCT_ISLOW).
  bool finish(std::uint8_t* rgb) {
    if (setjmp(back_) != 0) return false;
    info_.out_color_space = JCS_RGB;
    info_.dct_method = JDCT_ISLOW;
    jpeg_start_decompress(&info_);
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = rgb + std::size_t{3} * info_.output_width * info_.output_scanline;
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return true;
  }

  unsigned width() const { return info_.image_width; }
  unsigned height() const { return info_.image_height; }
  const char* message() const { return message_; }

 private:
  std::span<const std::uint8_t> bytes_;
  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  std::jmp_buf back_{};
  char message_[JMSG_LENGTH_MAX] = "";
};

}  // namespace

std::pair<int, int> jpeg_size(std::span<const std::uint8_t> bytes) {
  JpegReader reader(bytes);
  if (!reader.begin()) return {0, 0};
  return {static_cast<int>(reader.width()), static_cast<int>(reader.height())};
}

Result<Image> decode_jpeg(std::span<const std::uint8_t> bytes) {
  JpegReader reader(bytes);
  if (!reader.begin()) return error(fmt::format("can't decode JPEG: {}", reader.message()));
  const unsigned width = reader.width(), height = reader.height();
  if (width > max_picture_side || height > max_picture_side)
    return error(fmt::format("can't decode JPEG: it is {} x {} pixels", width, height),
                 fmt::format("at most {0} x {0} are read", max_picture_side));
  Image image{static_cast<int>(width), static_cast<int>(height),
              std::vector<std::uint8_t>(std::size_t{3} * width * height)};
  if (!reader.finish(image.pixels.data())) return error(fmt::format("can't decode JPEG: {}", reader.message()));
  return image;
}

}  // namespace rehearse
