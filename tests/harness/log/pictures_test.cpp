// Pictures in ROS messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "../../jpeg_file.h"
#include "core/kinds/recorded_image.h"
#include "logs/robot_log/sensor_codecs.h"
#include "picture/picture.h"

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
  const auto image = color_of(msg::CompressedImage{{}, "jpeg", test::jpeg_of_color(9, 5, {200, 100, 50})});
  ASSERT_TRUE(image.ok()) << to_string(image.errors());
  EXPECT_EQ(image->width, 9);
  EXPECT_EQ(image->height, 5);
  ASSERT_EQ(image->pixels.size(), 135u);
  EXPECT_NEAR(image->pixels[0], 200, 3);
  EXPECT_NEAR(image->pixels[1], 100, 3);
  EXPECT_NEAR(image->pixels[134], 50, 3);
}

TEST(PictureCodecs, ReadTheSizeFromTheHeader) {
  using Size = std::pair<int, int>;
  const std::vector<std::uint8_t> jpeg = test::jpeg_of_color(9, 5, {200, 100, 50});
  const std::vector<std::uint8_t> png = encode_png({300, 2, std::vector<std::uint8_t>(1800)});
  EXPECT_EQ(size_of_picture(jpeg), Size(9, 5));
  EXPECT_EQ(size_of_picture(png), Size(300, 2));
  EXPECT_EQ(size_of_picture(std::span(jpeg).first(20)), Size(0, 0));
  EXPECT_EQ(size_of_picture(std::span(png).first(20)), Size(0, 0));
  EXPECT_EQ(size_of_picture({}), Size(0, 0));
}

TEST(PictureCodecs, ReadPngWhateverTheFormatSays) {
  const Image image{1, 1, {1, 2, 3}};
  EXPECT_EQ(color_of(msg::CompressedImage{{}, "jpeg", encode_png(image)})->pixels, image.pixels);
}

TEST(PictureCodecs, RefuseWhatIsDamaged) {
  std::vector<std::uint8_t> bytes = test::jpeg_of_color(32, 32, {200, 100, 50});
  for (std::size_t length = 2; length < bytes.size(); length += 7) {
    const auto cut = decode_jpeg(std::span(bytes).first(length));
    EXPECT_FALSE(cut.ok()) << length << " of " << bytes.size() << " bytes are no picture";
  }
  EXPECT_THAT(to_string(color_of(msg::CompressedImage{{}, "webp", {1, 2, 3}}).errors()),
              HasSubstr("in 'webp', which is neither JPEG nor PNG"));
  EXPECT_FALSE(color_of(msg::CompressedImage{}).ok());
}

TEST(RecordedImages, AreTheFilesThatCame) {
  Image image{1, 1, {1, 2, 3}};
  const msg::CompressedImage drawn = message_of({}, image);
  EXPECT_EQ(drawn.format, "rgb8; png compressed");
  EXPECT_EQ(image_of(drawn)->pixels, image.pixels);

  const msg::CompressedImage logged{{}, "jpeg", test::jpeg_of_color(9, 5, {200, 100, 50})};
  image = *color_of(logged);
  image.file = logged.data;
  const msg::CompressedImage recorded = message_of({}, image);
  EXPECT_EQ(recorded.data, logged.data);
  const auto replayed = image_of(recorded);
  ASSERT_TRUE(replayed.ok()) << to_string(replayed.errors());
  EXPECT_EQ(replayed->pixels, image.pixels);
  EXPECT_EQ(replayed->file, logged.data) << "a recording of the replay has the same file";
}

/// Else a replay on a machine with another libjpeg would blame the controller.
TEST(RecordedImages, AreRefusedIfAnotherLibraryDecodesOtherPixels) {
  Image image{9, 5, std::vector<std::uint8_t>(135, 42)};  // not the pixels of the file
  image.file = test::jpeg_of_color(9, 5, {200, 100, 50});
  const auto replayed = image_of(message_of({}, image));
  ASSERT_FALSE(replayed.ok());
  EXPECT_EQ(replayed.errors()[0].message, "the JPEG has other pixels on this machine than in the recorded run");
}

}  // namespace
}  // namespace rehearse
