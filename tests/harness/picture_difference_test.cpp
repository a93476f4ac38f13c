// The pictures that show the differences between two pictures.
#include "small_traces.h"

#include <gmock/gmock.h>
#include <rehearse/compare.h>

#include <fstream>
#include <iterator>

namespace rehearse {
namespace {

using testing::SmallTick;
using testing::SmallTrace;
using testing::TemporaryFolder;
using Rgb = std::array<int, 3>;

class PictureDifference : public ::testing::Test {
 protected:
  std::vector<std::filesystem::path> write(const std::vector<ToleranceRule>& rules = {}) {
    const Trace golden = golden_.load(folder_ / "golden.mcap"), actual = actual_.load(folder_ / "run.mcap");
    const auto written =
        write_picture_differences(golden, actual, compare(golden, actual, rules), rules, folder_ / "run.mcap");
    EXPECT_TRUE(written) << to_string(written.errors());
    return *written;
  }

  static Image read(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    const auto image = decode_png(bytes);
    EXPECT_TRUE(image);
    return *image;
  }

  static Rgb at(const Image& image, int x, int y) {
    const std::uint8_t* pixel = image.pixels.data() + 3 * (y * image.width + x);
    return {pixel[0], pixel[1], pixel[2]};
  }

  TemporaryFolder folder_;
  SmallTrace golden_, actual_;
};

TEST_F(PictureDifference, StandsBesideTheExpectedAndTheActualPicture) {
  actual_.ticks[1].image.pixels[3 * 5] = 210;      // pixel (1, 1), beyond
  actual_.ticks[1].image.pixels[3 * 6 + 2] = 101;  // pixel (2, 1), within
  ToleranceRule rule;
  rule.channel = "Robot/Eye/*";
  rule.pixel_delta = 2.0;
  const auto files = write({rule});
  ASSERT_EQ(files, std::vector{folder_ / "run.Robot.Eye.image.png"});
  const Image image = read(files[0]);
  ASSERT_EQ(image.width, 3 * 4 + 2 * 4);
  ASSERT_EQ(image.height, 2);
  EXPECT_EQ(at(image, 1, 1), Rgb({100, 100, 100}));
  EXPECT_EQ(at(image, 8 + 1, 1), Rgb({210, 100, 100}));
  EXPECT_EQ(at(image, 16 + 0, 0), Rgb({30, 30, 30})) << "the same, dimmed";
  EXPECT_EQ(at(image, 16 + 1, 1), Rgb({230, 30, 30}));
  EXPECT_EQ(at(image, 16 + 2, 1), Rgb({240, 200, 40}));
  EXPECT_EQ(at(image, 5, 0), Rgb({255, 255, 255})) << "between two of them";
}

TEST_F(PictureDifference, IsTheFirstOfItsCamera) {
  actual_.ticks[1].image.pixels[0] = 200;
  actual_.ticks[2].image.pixels[3] = 200;
  const Image image = read(write().at(0));
  EXPECT_EQ(at(image, 16, 0), Rgb({230, 30, 30}));
  EXPECT_EQ(at(image, 17, 0), Rgb({30, 30, 30}));
}

TEST_F(PictureDifference, ShowsDistancesAsGreyAndNothingAsBlue) {
  actual_.ticks[0].depth = {1.0F, 2.0F, 3.0F, std::numeric_limits<float>::infinity()};
  const auto files = write();
  ASSERT_EQ(files, std::vector{folder_ / "run.Robot.Eye.depth.png"});
  const Image image = read(files[0]);
  const int width = (image.width - 8) / 3;
  EXPECT_EQ(at(image, 0, 0), Rgb({255, 255, 255}));
  EXPECT_EQ(at(image, width + 4, 0), Rgb({255, 255, 255}));
  const Image& whole = image;
  const int last_x = (4 - 1) % width, last_y = (4 - 1) / width;
  EXPECT_EQ(at(whole, last_x, last_y), Rgb({0, 0, 0}));
  EXPECT_EQ(at(whole, width + 4 + last_x, last_y), Rgb({40, 60, 140}));
  EXPECT_EQ(at(whole, 2 * (width + 4) + last_x, last_y), Rgb({230, 30, 30}));
}

TEST_F(PictureDifference, IsNotMadeOfWhatIsWithinTolerance) { EXPECT_TRUE(write().empty()); }

TEST_F(PictureDifference, OfAnEarlierComparisonIsRemoved) {
  actual_.ticks[1].image.pixels[0] = 200;
  write();
  std::ofstream(folder_ / "run.notes.png") << "mine";
  std::ofstream(folder_ / "runner.Robot.Eye.image.png") << "another's";
  actual_ = golden_;
  EXPECT_TRUE(write().empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "run.Robot.Eye.image.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run.notes.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "runner.Robot.Eye.image.png"));
}

TEST_F(PictureDifference, ThatCanNotBeWrittenIsTold) {
  actual_.ticks[1].image.pixels[0] = 200;
  const Trace golden = golden_.load(folder_ / "golden.mcap"), actual = actual_.load(folder_ / "run.mcap");
  const auto written =
      write_picture_differences(golden, actual, compare(golden, actual, {}), {}, folder_ / "no" / "run.mcap");
  ASSERT_FALSE(written);
  EXPECT_THAT(picture_lines(written), ::testing::HasSubstr("can't be written"));
}

}  // namespace
}  // namespace rehearse
