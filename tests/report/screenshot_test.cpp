// How reports look: screenshots of synthetic ones beside those that somebody has looked at (screenshots/), compared as
// pictures of cameras are. REHEARSE_SCREENSHOTS=renew in the environment makes them anew, to be looked at again.
#include "../harness/small_traces.h"

#include <gmock/gmock.h>
#include <rehearse/compare.h>
#include <rehearse/picture_difference.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>

#include "../interop/node.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using testing::SmallTrace;

std::string reason_to_skip() {
  if (test::run("node --version").status != 0) return "node is not installed";
  if (!fs::exists(fs::path(REPORT_TESTS) / "node_modules/playwright-core"))
    return std::string("run `npm ci` in ") + REPORT_TESTS;
  if (!fs::exists(REPORT_PAGE)) return "the page of reports was not built: run tools/setup, and build again";
  if (test::run("node -e \"import('" REPORT_TESTS "/browser.mjs').then((b) => process.exit(b.chromium_path() ? 0 : 1))\"")
          .status != 0)
    return "Chromium is not installed";
  return "";
}

Image read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
  auto image = decode_png(bytes);
  EXPECT_TRUE(image) << file << (image ? "" : ": " + to_string(image.errors()));
  return image ? *image : Image{};
}

/// A recording whose camera saw that.
Trace trace_of(const Image& image, const fs::path& file) {
  SmallTrace trace;
  trace.ticks.resize(1);
  trace.ticks[0].image = image;
  return trace.load(file);
}

/// Letters and edges are drawn a little otherwise by another version of the browser: a tenth of the pixels of any
/// square of 16 by 16 may, of all a fiftieth. What has moved, or another colour, is more than that.
std::vector<ToleranceRule> as_another_browser_draws() {
  ToleranceRule rule;
  rule.channel = "Robot/Eye/*";
  rule.pixel_delta = 48.0;
  rule.pixel_share = 0.02;
  rule.pixel_window = 0.45;
  return {rule};
}

class Screenshot : public ::testing::TestWithParam<const char*> {
 protected:
  static void SetUpTestSuite() {
    skip_ = reason_to_skip();
    if (!skip_.empty()) return;
    folder_ = fs::temp_directory_path() / ("rehearse_screenshots_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    const auto taken = test::run("node " + test::quoted(fs::path(REPORT_TESTS) / "screenshots.mjs") + " " +
                                 test::quoted(REPORT_PAGE) + " " + test::quoted(folder_));
    ASSERT_EQ(taken.status, 0) << taken.text;
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  void SetUp() override {
    if (!skip_.empty()) GTEST_SKIP() << skip_;
  }

  Comparison compare_with(const Image& expected, const Image& actual) {
    return compare(trace_of(expected, scratch_ / "expected.mcap"), trace_of(actual, scratch_ / "actual.mcap"),
                   as_another_browser_draws());
  }

  /// Beside the test program, where somebody can look at it.
  static fs::path kept(const std::string& name) {
    const fs::path folder = fs::path(KEPT_SCREENSHOTS);
    fs::create_directories(folder);
    return folder / name;
  }

  testing::TemporaryFolder scratch_;
  static inline fs::path folder_;
  static inline std::string skip_;
};

TEST_P(Screenshot, LooksAsItDidWhenSomebodyLookedAtIt) {
  const std::string name = GetParam();
  const fs::path approved = fs::path(REPORT_TESTS) / "screenshots" / (name + ".png"), taken = folder_ / (name + ".png");
  const char* what = std::getenv("REHEARSE_SCREENSHOTS");
  if (what && std::string(what) == "renew") {
    fs::create_directories(approved.parent_path());
    fs::copy_file(taken, approved, fs::copy_options::overwrite_existing);
    GTEST_SKIP() << "renewed " << approved << ": look at it";
  }
  const Image expected = read(approved), actual = read(taken);
  ASSERT_EQ(expected.width, actual.width);
  ASSERT_EQ(expected.height, actual.height);
  const Comparison comparison = compare_with(expected, actual);
  if (comparison.within) return;
  fs::copy_file(taken, kept(name + ".png"), fs::copy_options::overwrite_existing);
  const Trace golden = trace_of(expected, scratch_ / "golden.mcap"), run = trace_of(actual, scratch_ / "run.mcap");
  const auto written = write_picture_differences(golden, run, comparison, as_another_browser_draws(), kept(name + ".mcap"));
  FAIL() << (comparison.first ? to_string(*comparison.first) : "it differs") << picture_lines(written)
         << "\nif it is meant to look like this: REHEARSE_SCREENSHOTS=renew, look at it, commit it";
}

INSTANTIATE_TEST_SUITE_P(Reports, Screenshot, ::testing::Values("light", "dark", "narrow", "alone"),
                         [](const auto& name) { return std::string(name.param); });

using Tolerance = Screenshot;

// A button of the page, painted over.
TEST_F(Tolerance, FindsAButtonThatIsGone) {
  const Image expected = read(folder_ / "light.png");
  Image actual = expected;
  for (int y = 88; y < 108; ++y)
    for (int x = 590; x < 720; ++x)
      for (int c = 0; c < 3; ++c) actual.pixels[3 * (y * actual.width + x) + c] = 255;
  EXPECT_FALSE(compare_with(expected, actual).within);
}

TEST_F(Tolerance, LetsEdgesBeDrawnALittleOtherwise) {
  const Image expected = read(folder_ / "light.png");
  Image actual = expected;
  for (std::size_t i = 0; i < actual.pixels.size(); i += 7) actual.pixels[i] ^= 16;
  EXPECT_TRUE(compare_with(expected, actual).within);
}

}  // namespace
}  // namespace rehearse
