// A report of a run that is too long for it shows a part: which values, and how it names them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/report.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <random>

#include "../small_traces.h"
#include "decoded_report.h"

namespace rehearse::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

constexpr std::int64_t length = 8'000;          // [ticks]
constexpr std::size_t first_difference = 3000;  // [ticks]

class LongReport : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.page = plain_page(folder_ / "page.html");
    actual_.lengthen(length);
    actual_.left_out = {"/Robot/Eye/image", "/Robot/Eye/depth"};
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (SmallTick& tick : actual_.ticks) {
      tick.q = any(random);
      tick.u = any(random);
    }
    golden_ = actual_;
    for (std::size_t i = first_difference; i < actual_.ticks.size(); ++i) actual_.ticks[i].q += 0.01;
  }

  DecodedReport written(bool beside_golden) {
    actual_.write(folder_ / "actual.mcap");
    golden_.write(folder_ / "golden.mcap");
    const auto golden = beside_golden ? std::optional(folder_ / "golden.mcap") : std::nullopt;
    const auto summary = write_report(folder_ / "actual.mcap", golden, folder_ / "report.html", options_);
    EXPECT_TRUE(summary) << (summary ? "" : to_string(summary.errors()));
    if (summary) summary_ = *summary;
    return DecodedReport(folder_ / "report.html");
  }

  /// The values of a series of the run by tick.
  static std::map<std::int64_t, double> values(const DecodedReport& report, const std::string& name) {
    const Json& series = report.series(name);
    const auto ticks = report.ticks(series["axis"]);
    const auto bits = report.values(series);
    EXPECT_EQ(ticks.size(), bits.size());
    std::map<std::int64_t, double> values;
    for (std::size_t i = 0; i < bits.size(); ++i) values[ticks[i]] = std::bit_cast<double>(bits[i]);
    return values;
  }

  test::TemporaryFolder folder_;
  SmallTrace actual_, golden_;
  ReportOptions options_;
  ReportSummary summary_;
};

TEST_F(LongReport, ShowsAllThatFits) {
  const DecodedReport report = written(true);
  EXPECT_EQ(values(report, "Robot/KNEE/q").size(), actual_.ticks.size());
  EXPECT_THAT(summary_.omitted, Not(Contains(HasSubstr("too long"))));
}

TEST_F(LongReport, IsNotMuchLargerThanItMayBe) {
  for (const std::uintmax_t size : {160'000, 80'000, 40'000}) {
    options_.max_size = size;
    written(true);
    EXPECT_LT(summary_.data_bytes, size + size / 10) << size;
    EXPECT_GT(summary_.data_bytes, size / 3) << size;
    EXPECT_THAT(summary_.omitted, Contains(HasSubstr("too long to show all values"))) << size;
  }
}

TEST_F(LongReport, HasTheTicksAroundTheFirstDifference) {
  options_.max_size = 80'000;
  const DecodedReport report = written(true);
  EXPECT_EQ(summary_.first_tick, static_cast<std::int64_t>(first_difference));
  const auto shown = values(report, "Robot/KNEE/q");
  EXPECT_LT(shown.size(), actual_.ticks.size() / 2);
  for (std::int64_t tick = first_difference - 100; tick < static_cast<std::int64_t>(first_difference) + 100; ++tick) {
    ASSERT_TRUE(shown.contains(tick)) << tick;
    EXPECT_EQ(shown.at(tick), actual_.ticks[static_cast<std::size_t>(tick)].q);
  }
  EXPECT_THAT(summary_.omitted, Contains(HasSubstr(" all values are shown")));
}

TEST_F(LongReport, HasFirstAndLastTickAndTheRangeOfAllValues) {
  actual_.ticks[5'345].q = 70.0;
  actual_.ticks[1'321].q = -50.0;
  options_.max_size = 80'000;
  const DecodedReport report = written(false);
  const auto shown = values(report, "Robot/KNEE/q");
  ASSERT_TRUE(shown.contains(5'345) && shown.contains(1'321));
  EXPECT_EQ(shown.at(5'345), 70.0);
  EXPECT_EQ(shown.at(1'321), -50.0);
  EXPECT_EQ(shown.begin()->first, 0);
  EXPECT_EQ(shown.rbegin()->first, length - 1);
  EXPECT_EQ(report.series("Robot/KNEE/q")["range"], Json({-50.0, 70.0}));
  EXPECT_EQ(report["runs"][0]["ticks"], 3) << "as the recording states";
}

/// The lowest and highest values of each stretch of time, so that a plot of the whole run shows its peaks.
TEST_F(LongReport, HasPeaksEverywhere) {
  std::vector<std::int64_t> peaks;
  for (std::int64_t tick = 137; tick < length; tick += 997) peaks.push_back(tick);
  for (const std::int64_t tick : peaks) actual_.ticks[static_cast<std::size_t>(tick)].u = 40.0 + 1e-3 * tick;
  options_.max_size = 80'000;
  const DecodedReport report = written(false);
  std::vector<std::int64_t> ticks;
  for (const auto& [tick, value] : values(report, "Robot/Pd/output/KNEE/u")) ticks.push_back(tick);
  EXPECT_LT(ticks.size(), actual_.ticks.size() / 2);
  EXPECT_THAT(ticks, IsSupersetOf(peaks));
}

TEST_F(LongReport, CountsAllDifferencesAndHasTheFirstOfEachSeries) {
  golden_.ticks[6'555].force = 651.0;
  options_.max_size = 80'000;
  const DecodedReport report = written(true);
  const Json& q = report.series("Robot/KNEE/q");
  EXPECT_EQ(q["differing"], length - static_cast<std::int64_t>(first_difference));
  EXPECT_EQ(q["beyond"], length - static_cast<std::int64_t>(first_difference));
  EXPECT_EQ(report.series("Robot/Pd/output/KNEE/u")["golden"], "same");
  const Json& force = report.series("Robot/Foot/force/z");
  ASSERT_FALSE(force.is_null());
  EXPECT_EQ(force["differing"], 1);
  EXPECT_NE(force["golden"], "same");
  EXPECT_TRUE(values(report, "Robot/Foot/force/z").contains(6'555));
}

TEST_F(LongReport, ShowsPicturesAtEqualDistances) {
  actual_.left_out = golden_.left_out = {};
  std::mt19937 random(3);
  actual_.ticks.resize(2000);
  for (SmallTick& tick : actual_.ticks) {
    tick.image = {32, 32, std::vector<std::uint8_t>(3 * 32 * 32)};
    for (std::uint8_t& byte : tick.image.pixels) byte = static_cast<std::uint8_t>(random());
  }
  golden_.ticks = actual_.ticks;
  golden_.ticks[1300].image.pixels[0] ^= 0xff;
  options_.max_size = 2'000'000;
  const DecodedReport report = written(true);
  EXPECT_LT(summary_.data_bytes, 2'200'000u);
  std::vector<std::int64_t> ticks;
  for (const Json& picture : report["cameras"][0]["pictures"]) ticks.push_back(picture["tick"]);
  EXPECT_TRUE(std::ranges::is_sorted(ticks));
  EXPECT_GT(ticks.size(), 50u);
  EXPECT_LT(ticks.size(), 500u);
  EXPECT_EQ(ticks.front(), 0);
  EXPECT_EQ(ticks.back(), 1999);
  for (std::int64_t tick = 1295; tick < 1305; ++tick) EXPECT_THAT(ticks, Contains(tick));
  EXPECT_THAT(summary_.omitted, Contains(HasSubstr("of the 2000 pictures of /Robot/Eye/image are shown")));
}

}  // namespace
}  // namespace rehearse::testing
