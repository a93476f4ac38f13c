#include <gtest/gtest.h>
#include <png.h>
#include <cnoid/Image>

#include <cstring>
#include <filesystem>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace {

using cnoid::Image;

/// Pixels that all differ from their neighbours.
Image counting_image(int width, int height, int components) {
  Image image;
  image.setSize(width, height, components);
  const int size = width * height * components;
  for (int i = 0; i < size; ++i) image.pixels()[i] = static_cast<unsigned char>(i * 7);
  return image;
}

/// The pixels of a PNG file as libpng reads them, converted to `format`.
std::vector<unsigned char> read_png(const std::string& path, png_uint_32 format, int& width, int& height) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&png, path.c_str()), 0) << png.message;
  EXPECT_EQ(png.format, format);
  std::vector<unsigned char> pixels(PNG_IMAGE_SIZE(png));
  EXPECT_NE(png_image_finish_read(&png, nullptr, pixels.data(), 0, nullptr), 0) << png.message;
  width = static_cast<int>(png.width);
  height = static_cast<int>(png.height);
  return pixels;
}

std::string scratch_file(const std::string& name) {
  return (std::filesystem::path(testing::TempDir()) / ("rehearse_" + name)).string();
}

TEST(Image, IsEmptyUntilItHasASize) {
  Image image;
  EXPECT_TRUE(image.empty());
  image.setSize(4, 2, 3);
  EXPECT_FALSE(image.empty());
  EXPECT_FALSE(image.hasAlphaComponent());
  image.reset();
  EXPECT_TRUE(image.empty());
  EXPECT_EQ(image.width(), 0);
}

TEST(Image, RefusesImpossibleSizes) {
  Image image;
  EXPECT_THROW(image.setSize(-1, 1, 3), std::invalid_argument);
  EXPECT_THROW(image.setSize(1, 1, 5), std::invalid_argument);
  EXPECT_THROW(image.setSize(1, 1, 0), std::invalid_argument);
}

TEST(Image, ClearsToBlackAtTheSameSize) {
  Image image = counting_image(2, 2, 3);
  image.clear();
  EXPECT_EQ(image.width(), 2);
  EXPECT_EQ(std::accumulate(image.pixels(), image.pixels() + 12, 0), 0);
}

TEST(Image, FlipsItsRows) {
  Image image = counting_image(1, 3, 1);
  image.applyVerticalFlip();
  EXPECT_EQ(image.pixels()[0], 14);
  EXPECT_EQ(image.pixels()[1], 7);
  EXPECT_EQ(image.pixels()[2], 0);
}

struct PngForm {
  int components;
  png_uint_32 format;
};

void PrintTo(const PngForm& form, std::ostream* stream) { *stream << form.components << " components"; }

class SavedImage : public testing::TestWithParam<PngForm> {};

TEST_P(SavedImage, IsAPngWithTheSamePixels) {
  // More than one stored block of 65535 bytes, and a width that is no multiple of anything.
  const Image image = counting_image(211, 400, GetParam().components);
  const std::string path = scratch_file(std::to_string(GetParam().components) + ".png");
  ASSERT_TRUE(image.save(path));
  int width = 0;
  int height = 0;
  const std::vector<unsigned char> pixels = read_png(path, GetParam().format, width, height);
  std::filesystem::remove(path);
  EXPECT_EQ(width, 211);
  EXPECT_EQ(height, 400);
  const std::size_t size = 211u * 400u * static_cast<std::size_t>(GetParam().components);
  EXPECT_EQ(pixels, std::vector<unsigned char>(image.pixels(), image.pixels() + size));
}

INSTANTIATE_TEST_SUITE_P(Components, SavedImage,
                         testing::Values(PngForm{1, PNG_FORMAT_GRAY}, PngForm{2, PNG_FORMAT_GA},
                                         PngForm{3, PNG_FORMAT_RGB}, PngForm{4, PNG_FORMAT_RGBA}),
                         [](const auto& test) { return "Of" + std::to_string(test.param.components); });

TEST(Image, SavesNothingButPng) {
  std::ostringstream message;
  EXPECT_FALSE(counting_image(1, 1, 3).save(scratch_file("image.jpg"), message));
  EXPECT_NE(message.str().find("can only be saved as .png"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(scratch_file("image.jpg")));
}

TEST(Image, SaysWhyItWasNotSaved) {
  std::ostringstream message;
  EXPECT_FALSE(Image().save(scratch_file("empty.png"), message));
  EXPECT_NE(message.str().find("the image is empty"), std::string::npos);
  EXPECT_FALSE(counting_image(1, 1, 3).save("/no/such/folder/image.png", message));
  EXPECT_NE(message.str().find("/no/such/folder/image.png: can't be written"), std::string::npos);
  EXPECT_FALSE(counting_image(1, 1, 3).save("/no/such/folder/image.png"));
}

}  // namespace
