// Pictures in ROS messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include <jpeglib.h>

#include "log/picture_codecs.h"
#include "png/png.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;

msg::Image picture(const std::string& encoding, std::uint32_t width, std::uint32_t height, std::uint32_t step,
                   std::vector<std::uint8_t> data) {
  msg::Image image;
  image.encoding = encoding;
  image.width = width;
  image.height = height;
  image.step = step;
  image.data = std::move(data);
  return image;
}

/// A picture of one colour.
std::vector<std::uint8_t> jpeg_of(unsigned width, unsigned height, std::uint8_t red, std::uint8_t green,
                                  std::uint8_t blue) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = width;
  jpeg.image_height = height;
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<std::uint8_t> row;
  for (unsigned x = 0; x < width; ++x) row.insert(row.end(), {red, green, blue});
  while (jpeg.next_scanline < height) {
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&jpeg, &rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::vector<std::uint8_t> bytes(buffer, buffer + size);
  jpeg_destroy_compress(&jpeg);
  std::free(buffer);
  return bytes;
}

TEST(PictureCodecs, ReadTheUsualEncodings) {
  const std::vector<std::uint8_t> one{10, 20, 30};
  EXPECT_EQ(color_of(picture("rgb8", 1, 1, 3, {10, 20, 30}))->pixels, one);
  EXPECT_EQ(color_of(picture("bgr8", 1, 1, 3, {30, 20, 10}))->pixels, one);
  EXPECT_EQ(color_of(picture("rgba8", 1, 1, 4, {10, 20, 30, 99}))->pixels, one);
  EXPECT_EQ(color_of(picture("bgra8", 1, 1, 4, {30, 20, 10, 99}))->pixels, one);
  EXPECT_EQ(color_of(picture("mono8", 1, 1, 1, {42}))->pixels, (std::vector<std::uint8_t>{42, 42, 42}));
}

TEST(PictureCodecs, PassOverThePaddingOfRows) {
  const auto image = color_of(picture("mono8", 1, 2, 4, {1, 9, 9, 9, 2, 9, 9, 9}));
  ASSERT_TRUE(image.ok());
  EXPECT_EQ(image->pixels, (std::vector<std::uint8_t>{1, 1, 1, 2, 2, 2}));
}

TEST(PictureCodecs, RefuseWhatIsNoPicture) {
  EXPECT_THAT(to_string(color_of(picture("bayer_rggb8", 1, 1, 1, {1})).errors()),
              HasSubstr("'bayer_rggb8' (read are rgb8, bgr8"));
  EXPECT_FALSE(color_of(picture("rgb8", 2, 2, 6, std::vector<std::uint8_t>(11))).ok());
  EXPECT_FALSE(color_of(picture("rgb8", 2, 2, 5, std::vector<std::uint8_t>(12))).ok());
  EXPECT_FALSE(color_of(picture("rgb8", 0, 0, 0, {})).ok());
  EXPECT_FALSE(color_of(picture("rgb8", 4'000'000'000u, 2, 4'000'000'000u, std::vector<std::uint8_t>(12))).ok());
}

TEST(PictureCodecs, ReadDistances) {
  const float none = std::numeric_limits<float>::infinity();
  const auto millimetres = depth_of(picture("16UC1", 2, 1, 4, {0xe8, 0x03, 0, 0}));
  ASSERT_TRUE(millimetres.ok());
  EXPECT_EQ(millimetres->meters, (std::vector<float>{1.0f, none}));
  msg::Image big = picture("16UC1", 1, 1, 2, {0x03, 0xe8});
  big.is_bigendian = 1;
  EXPECT_EQ(depth_of(big)->meters, std::vector<float>{1.0f});
  const float metres[] = {2.5f, -none, 0.0f, std::numeric_limits<float>::quiet_NaN()};
  std::vector<std::uint8_t> bytes(sizeof metres);
  std::memcpy(bytes.data(), metres, sizeof metres);
  const std::vector<float> read = depth_of(picture("32FC1", 4, 1, 16, bytes))->meters;
  EXPECT_EQ((std::vector<float>{read[0], read[1], read[2]}), (std::vector<float>{2.5f, -none, none}));
  EXPECT_TRUE(std::isnan(read[3])) << "not a measurement";
  EXPECT_THAT(to_string(depth_of(picture("rgb8", 1, 1, 3, {1, 2, 3})).errors()), HasSubstr("32FC1 [m] and 16UC1 [mm]"));
}

TEST(PictureCodecs, ReadJpeg) {
  const auto image = color_of(msg::CompressedImage{{}, "jpeg", jpeg_of(9, 5, 200, 100, 50)});
  ASSERT_TRUE(image.ok()) << to_string(image.errors());
  EXPECT_EQ(image->width, 9);
  EXPECT_EQ(image->height, 5);
  ASSERT_EQ(image->pixels.size(), 135u);
  EXPECT_NEAR(image->pixels[0], 200, 3);
  EXPECT_NEAR(image->pixels[1], 100, 3);
  EXPECT_NEAR(image->pixels[134], 50, 3);
}

TEST(PictureCodecs, ReadPngWhateverTheFormatSays) {
  const Image image{1, 1, {1, 2, 3}};
  EXPECT_EQ(color_of(msg::CompressedImage{{}, "jpeg", encode_png(image)})->pixels, image.pixels);
}

TEST(PictureCodecs, RefuseWhatIsDamaged) {
  std::vector<std::uint8_t> bytes = jpeg_of(32, 32, 200, 100, 50);
  for (std::size_t length = 2; length < bytes.size(); length += 7) {
    const auto cut = decode_jpeg(std::span(bytes).first(length));
    EXPECT_FALSE(cut.ok()) << length << " of " << bytes.size() << " bytes are no picture";
  }
  EXPECT_THAT(to_string(color_of(msg::CompressedImage{{}, "webp", {1, 2, 3}}).errors()),
              HasSubstr("in 'webp', which is neither JPEG nor PNG"));
  EXPECT_FALSE(color_of(msg::CompressedImage{}).ok());
}

}  // namespace
}  // namespace rehearse
