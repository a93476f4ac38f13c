#include "picture/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <string>

namespace rehearse {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Random pixels, the same ones each time.
Image noise(int width, int height) {
  Image image{width, height, Bytes(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)};
  std::uint32_t state = 1;
  for (std::uint8_t& sample : image.pixels) {
    state = state * 1664525u + 1013904223u;
    sample = static_cast<std::uint8_t>(state >> 24);
  }
  return image;
}

Bytes written_by_libpng(std::uint32_t format, std::uint32_t width, std::uint32_t height, const void* pixels,
                        const void* color_map = nullptr, std::uint32_t colors = 0) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = format;
  image.colormap_entries = colors;
  png_alloc_size_t size = 0;
  EXPECT_TRUE(png_image_write_to_memory(&image, nullptr, &size, 0, pixels, 0, color_map)) << image.message;
  Bytes bytes(size);
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels, 0, color_map)) << image.message;
  return bytes;
}

Bytes pixels_of(const Bytes& file) {
  const Result<Image> image = decode_png(file);
  if (image) return image->pixels;
  ADD_FAILURE() << to_string(image.errors());
  return {};
}

std::string message_of(const Bytes& file) {
  const Result<Image> image = decode_png(file);
  return image ? "decoded" : image.errors().front().message;
}

class PngRoundTrip : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(PngRoundTrip, GivesEveryPixelBack) {
  const Image image = noise(GetParam().first, GetParam().second);
  const Result<Image> back = decode_png(encode_png(image));
  ASSERT_TRUE(back) << to_string(back.errors());
  EXPECT_EQ(back->width, image.width);
  EXPECT_EQ(back->height, image.height);
  EXPECT_TRUE(back->pixels == image.pixels);
}

INSTANTIATE_TEST_SUITE_P(Sizes, PngRoundTrip,
                         testing::Values(std::pair(1, 1), std::pair(1, 300), std::pair(300, 1), std::pair(7, 5),
                                         std::pair(640, 480), std::pair(20, 8000)),
                         [](const auto& instance) {
                           return std::to_string(instance.param.first) + "x" + std::to_string(instance.param.second);
                         });

TEST(Png, GivesEveryPixelBackForAnyNumberOfColours) {
  for (const int colors : {1, 2, 3, 4, 5, 16, 17, 255, 256, 257, 600}) {
    for (const int width : {1, 3, 8, 37}) {  // rows that fill their last byte, and rows that don't
      Image image{width, 80, {}};
      for (int i = 0; i < width * 80; ++i) {
        const int color = (i / 2) % colors;  // pairs of equal pixels; now and then a row equals the one above it
        image.pixels.insert(image.pixels.end(),
                            {static_cast<std::uint8_t>(color), static_cast<std::uint8_t>(color / 256),
                             static_cast<std::uint8_t>(255 - color % 7)});
      }
      const Result<Image> back = decode_png(encode_png(image));
      ASSERT_TRUE(back.ok()) << to_string(back.errors());
      ASSERT_EQ(back->pixels, image.pixels) << colors << " colours, width " << width;
    }
  }
}

TEST(Png, IsTheSameForTheSamePixels) { EXPECT_EQ(encode_png(noise(64, 48)), encode_png(noise(64, 48))); }

TEST(Png, OfAnEvenPictureIsSmall) {
  const Image even{640, 480, Bytes(640 * 480 * 3, 0x55)};
  EXPECT_LT(encode_png(even).size(), 10000u);
}

TEST(Png, DecodesGrey) {
  const Bytes grey = {10, 200};
  EXPECT_EQ(pixels_of(written_by_libpng(PNG_FORMAT_GRAY, 2, 1, grey.data())), (Bytes{10, 10, 10, 200, 200, 200}));
}

TEST(Png, DropsAlphaWithoutBlending) {
  const Bytes rgba = {10, 20, 30, 0, 40, 50, 60, 128};
  EXPECT_EQ(pixels_of(written_by_libpng(PNG_FORMAT_RGBA, 2, 1, rgba.data())), (Bytes{10, 20, 30, 40, 50, 60}));
}

TEST(Png, DecodesAPalette) {
  const Bytes indices = {1, 0};
  const Bytes colors = {1, 2, 3, 4, 5, 6};
  EXPECT_EQ(pixels_of(written_by_libpng(PNG_FORMAT_RGB_COLORMAP, 2, 1, indices.data(), colors.data(), 2)),
            (Bytes{4, 5, 6, 1, 2, 3}));
}

TEST(Png, RefusesSixteenBitsASample) {
  const std::uint16_t linear[] = {1, 2, 3};
  EXPECT_EQ(message_of(written_by_libpng(PNG_FORMAT_LINEAR_RGB, 1, 1, linear)),
            "can't decode PNG: it has 16 bits a sample");
}

TEST(Png, RefusesAPictureTooLargeToBeOne) {
  const Bytes row(8193, 0);
  EXPECT_EQ(message_of(written_by_libpng(PNG_FORMAT_GRAY, 8193, 1, row.data())),
            "can't decode PNG: it is 8193 x 1 pixels");
}

TEST(Png, SaysThatSomethingElseIsNoPng) {
  const std::string text = "version https://git-lfs.github.com/spec/v1\n";
  EXPECT_EQ(message_of(Bytes(text.begin(), text.end())), "can't decode PNG: Not a PNG file");
  EXPECT_THAT(message_of({}), testing::StartsWith("can't decode PNG: "));
}

TEST(Png, NoticesThatTheFileEndsTooEarly) {
  const Bytes file = encode_png(noise(8, 6));
  constexpr std::size_t end_chunk = 12;  // holds nothing
  for (std::size_t size = 0; size < file.size() - end_chunk; ++size) {
    EXPECT_FALSE(decode_png(std::span(file).first(size)).ok()) << size << " of " << file.size() << " bytes";
  }
}

TEST(Png, NoticesEveryFlippedBit) {
  const Bytes file = encode_png(noise(8, 6));
  constexpr std::size_t end_chunk = 12;
  for (std::size_t bit = 0; bit < (file.size() - end_chunk) * 8; ++bit) {
    Bytes flipped = file;
    flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ (1u << (bit % 8)));
    EXPECT_FALSE(decode_png(flipped).ok()) << "bit " << bit % 8 << " of byte " << bit / 8;
  }
}

TEST(Png, NamesABrokenChecksum) {
  Bytes file = encode_png(noise(8, 6));
  file[20] ^= 1;  // in the width, so that nothing else is wrong with it
  EXPECT_THAT(message_of(file), testing::HasSubstr("CRC"));
}

}  // namespace
}  // namespace rehearse
