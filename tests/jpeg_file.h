// Writes JPEGs, which Rehearse only reads. Link JPEG::JPEG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <jpeglib.h>  // needs the headers above

namespace rehearse::test {

/// The JPEG of a picture. The number of `pixels` of each place determines the colours: 1 is grey, 3 RGB, 4 CMYK.
inline std::vector<std::uint8_t> jpeg_file(unsigned width, unsigned height, const std::vector<std::uint8_t>& pixels,
                                           int quality = 100) {
  const std::size_t colors = pixels.size() / (std::size_t{width} * height);
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = static_cast<int>(colors);
  jpeg.in_color_space = colors == 1 ? JCS_GRAYSCALE : colors == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < height) {
    JSAMPROW row = const_cast<JSAMPROW>(&pixels[jpeg.next_scanline * width * colors]);  // libjpeg only reads it
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  const std::vector<std::uint8_t> file(bytes, bytes + size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return file;
}

/// Of one colour, with that many components.
inline std::vector<std::uint8_t> jpeg_of_color(unsigned width, unsigned height,
                                               const std::vector<std::uint8_t>& color) {
  std::vector<std::uint8_t> pixels;
  for (std::size_t i = 0; i < std::size_t{width} * height; ++i) pixels.insert(pixels.end(), color.begin(), color.end());
  return jpeg_file(width, height, pixels);
}

}  // namespace rehearse::test
