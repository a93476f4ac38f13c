#include "mesh/picture_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <string>

#include "../../jpeg_file.h"

namespace rehearse {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string png(unsigned width, unsigned height, png_uint_32 format, const std::vector<std::uint8_t>& pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = format;
  png_alloc_size_t size = 0;
  EXPECT_TRUE(png_image_write_to_memory(&image, nullptr, &size, 0, pixels.data(), 0, nullptr));
  std::string bytes(size, '\0');
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr));
  return bytes;
}

std::string jpeg(unsigned width, unsigned height, const std::vector<std::uint8_t>& color) {
  const std::vector<std::uint8_t> file = test::jpeg_of_color(width, height, color);
  return {file.begin(), file.end()};
}

std::string picture_refusal(const std::string& bytes) {
  const Result<Texture> texture = decode_texture(bytes);
  if (texture) return "it was accepted";
  return to_string(texture.errors());
}

TEST(PictureFile, IsAPngWithItsOpacity) {
  const std::vector<std::uint8_t> pixels{1, 2, 3, 4, 5, 6, 7, 8};
  const Result<Texture> texture = decode_texture(png(1, 2, PNG_FORMAT_RGBA, pixels));
  ASSERT_TRUE(texture) << to_string(texture.errors());
  EXPECT_EQ(texture->width, 1);
  EXPECT_EQ(texture->height, 2);
  EXPECT_EQ(texture->rgba, pixels);  // the top row first
}

TEST(PictureFile, IsAPngOfGrey) {
  const Result<Texture> texture = decode_texture(png(2, 1, PNG_FORMAT_GRAY, {10, 200}));
  ASSERT_TRUE(texture) << to_string(texture.errors());
  EXPECT_THAT(texture->rgba, ElementsAre(10, 10, 10, 255, 200, 200, 200, 255));
}

TEST(PictureFile, IsAJpeg) {
  const Result<Texture> texture = decode_texture(jpeg(17, 9, {200, 100, 50}));
  ASSERT_TRUE(texture) << to_string(texture.errors());
  EXPECT_EQ(texture->width, 17);
  EXPECT_EQ(texture->height, 9);
  ASSERT_EQ(texture->rgba.size(), 4u * 17 * 9);
  for (std::size_t i = 0; i < texture->rgba.size(); i += 4) {
    EXPECT_NEAR(texture->rgba[i], 200, 2);
    EXPECT_NEAR(texture->rgba[i + 1], 100, 2);
    EXPECT_NEAR(texture->rgba[i + 2], 50, 2);
    EXPECT_EQ(texture->rgba[i + 3], 255);
  }
}

TEST(PictureFile, IsAJpegOfGrey) {
  const Result<Texture> texture = decode_texture(jpeg(1, 1, {77}));
  ASSERT_TRUE(texture) << to_string(texture.errors());
  EXPECT_THAT(texture->rgba, ElementsAre(77, 77, 77, 255));
}

TEST(PictureFile, ThatIsDamagedIsRefusedAndDoesNotEndTheProcess) {
  for (const std::string& whole :
       {png(8, 8, PNG_FORMAT_RGB, std::vector<std::uint8_t>(192, 9)), jpeg(8, 8, {1, 2, 3})}) {
    ASSERT_TRUE(decode_texture(whole));
    for (std::size_t length = 0; length + 12 < whole.size(); ++length) {  // a PNG's pixels end there
      EXPECT_THAT(picture_refusal(whole.substr(0, length)), HasSubstr("error: ")) << length << " of " << whole.size();
    }
  }
  EXPECT_THAT(picture_refusal(jpeg(8, 8, {1, 2, 3, 4})), HasSubstr("error: "));  // CMYK
}

TEST(PictureFile, OfAnotherKindIsToldApart) {
  EXPECT_THAT(picture_refusal("GIF89a"), HasSubstr("it is neither PNG nor JPEG"));
  EXPECT_THAT(picture_refusal("version https://git-lfs.github.com/spec/v1"), HasSubstr("git-lfs pointer"));
}

TEST(PictureFile, OfTooManyPixelsIsRefused) {
  EXPECT_THAT(picture_refusal(jpeg(8193, 1, {1})), HasSubstr("it is 8193 x 1 pixels (at most 8192 x 8192 are read)"));
  EXPECT_THAT(picture_refusal(png(1, 8193, PNG_FORMAT_GRAY, std::vector<std::uint8_t>(8193))), HasSubstr("1 x 8193"));
}

}  // namespace
}  // namespace rehearse
