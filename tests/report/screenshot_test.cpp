// The appearance of reports: screenshots of synthetic reports, compared with reviewed ones (screenshots/) like pictures
// of cameras. REHEARSE_SCREENSHOTS=renew in the environment makes them anew, for a new review.
#include "../harness/small_traces.h"

#include <gmock/gmock.h>
#include <rehearse/compare.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <tuple>

#include "support/shell.h"

namespace rehearse {
namespace {

namespace fs = std::filesystem;
using testing::SmallTrace;

std::string reason_to_skip() {
  if (test::run("node --version").status != 0) return "node is not installed";
  if (!fs::exists(fs::path(REPORT_TESTS) / "node_modules/playwright-core"))
    return std::string("run `npm ci` in ") + REPORT_TESTS;
  if (!fs::exists(REPORT_PAGE)) return "the page of reports was not built: run tools/setup, and build again";
  if (test::run("node -e \"import('" REPORT_TESTS
                "/browser.mjs').then((b) => process.exit(b.chromium_path() ? 0 : 1))\"")
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

/// Letters and edges are drawn a little otherwise by another version of the browser: an eighth of the pixels of any
/// square of 16 by 16 may be other ones, of all a fiftieth. What has moved, or has another colour, is more than that.
std::vector<ToleranceRule> as_another_browser_draws() {
  ToleranceRule rule;
  rule.channel = "Robot/Eye/*";
  rule.pixel_delta = 48.0;
  rule.pixel_share = 0.02;
  rule.pixel_window = 0.12;
  return {rule};
}

Image approved(const std::string& name) { return read(fs::path(REPORT_TESTS) / "screenshots" / (name + ".png")); }

class Screenshots : public ::testing::Test {
 protected:
  Comparison compare_with(const Image& expected, const Image& actual) {
    return compare(trace_of(expected, scratch_ / "expected.mcap"), trace_of(actual, scratch_ / "actual.mcap"),
                   as_another_browser_draws());
  }
  void expect_as_approved(const std::string& name);

  testing::TemporaryFolder scratch_;
};

using ReportPage = Screenshots;

/// Takes the picture anew and compares it; or keeps it, where that is asked for.
void Screenshots::expect_as_approved(const std::string& name) {
  if (const std::string reason = reason_to_skip(); !reason.empty()) GTEST_SKIP() << reason;
  const fs::path taken = scratch_ / "taken.png", folder = fs::path(REPORT_TESTS) / "screenshots";
  const auto taking = test::run("REHEARSE_COMMAND=" + test::quoted(REHEARSE_COMMAND) + " node " +
                                test::quoted(fs::path(REPORT_TESTS) / "screenshots.mjs") + " " +
                                test::quoted(REPORT_PAGE) + " " + test::quoted(taken) + " " + name);
  ASSERT_EQ(taking.status, 0) << taking.text;
  const char* what = std::getenv("REHEARSE_SCREENSHOTS");
  if (what && std::string(what) == "renew") {
    fs::create_directories(folder);
    fs::copy_file(taken, folder / (name + ".png"), fs::copy_options::overwrite_existing);
    GTEST_SKIP() << "made anew in " << folder << ": look at it";
  }
  const Image expected = approved(name), actual = read(taken);
  ASSERT_EQ(expected.width, actual.width);
  ASSERT_EQ(expected.height, actual.height);
  const Comparison comparison = compare_with(expected, actual);
  if (comparison.within) return;
  const fs::path kept = fs::path(KEPT_SCREENSHOTS) / name;  // for a review by a person
  fs::create_directories(kept.parent_path());
  fs::copy_file(taken, kept.string() + ".png", fs::copy_options::overwrite_existing);
  const Trace golden = trace_of(expected, scratch_ / "golden.mcap"), run = trace_of(actual, scratch_ / "run.mcap");
  const auto pictures =
      write_picture_differences(golden, run, comparison, as_another_browser_draws(), kept.string() + ".mcap");
  FAIL() << (comparison.first ? to_string(*comparison.first) : "it differs") << picture_lines(pictures)
         << "\nif it is meant to look like " << kept.string()
         << ".png: run this test with REHEARSE_SCREENSHOTS=renew, look at what it made, and commit it";
}

TEST_F(ReportPage, LooksAsApprovedInLight) { expect_as_approved("light"); }
TEST_F(ReportPage, LooksAsApprovedOnATelephoneInDark) { expect_as_approved("narrow_dark"); }
TEST_F(ReportPage, LooksAsApprovedOfOneRunWithoutCameras) { expect_as_approved("alone"); }
TEST_F(ReportPage, LooksAsApprovedWithACoverage) { expect_as_approved("coverage_light"); }
#if AT_NIGHT  // other sizes and colours of the same pages
TEST_F(ReportPage, LooksAsApprovedInDark) { expect_as_approved("dark"); }
TEST_F(ReportPage, LooksAsApprovedInALargeWindow) { expect_as_approved("wide_light"); }
TEST_F(ReportPage, LooksAsApprovedInALargeWindowInDark) { expect_as_approved("wide_dark"); }
TEST_F(ReportPage, LooksAsApprovedOnATelephone) { expect_as_approved("narrow_light"); }
TEST_F(ReportPage, LooksAsApprovedWithACoverageInDark) { expect_as_approved("coverage_dark"); }
#endif

/// A page at a width [px] in a theme: "history_420_dark".
class EveryPage : public Screenshots,
                  public ::testing::WithParamInterface<std::tuple<const char*, int, const char*>> {};

TEST_P(EveryPage, LooksAsApproved) {
  const auto [page, width, theme] = GetParam();
  expect_as_approved(std::string(page) + "_" + std::to_string(width) + "_" + theme);
}

INSTANTIATE_TEST_SUITE_P(Of, EveryPage,
                         ::testing::Combine(::testing::Values("index", "history", "campaign", "coverage_page"),
                                            ::testing::Values(1280, 420), ::testing::Values("light", "dark")),
                         [](const auto& info) {
                           return std::string(std::get<0>(info.param)) + "_" + std::to_string(std::get<1>(info.param)) +
                                  "_" + std::get<2>(info.param);
                         });

// A button of the page, painted over.
TEST_F(Screenshots, ThatLackAButtonAreFound) {
  const Image expected = approved("light");
  Image actual = expected;
  for (int y = 107; y < 127; ++y)
    for (int x = 590; x < 720; ++x)
      for (int c = 0; c < 3; ++c) actual.pixels[3 * static_cast<std::size_t>(y * actual.width + x) + c] = 255;
  EXPECT_FALSE(compare_with(expected, actual).within);
}

TEST_F(Screenshots, MayHaveOtherEdges) {
  const Image expected = approved("light");
  Image actual = expected;
  for (std::size_t i = 0; i < actual.pixels.size(); i += 7) actual.pixels[i] ^= 16;
  EXPECT_TRUE(compare_with(expected, actual).within);
}

}  // namespace
}  // namespace rehearse
