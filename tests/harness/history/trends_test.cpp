// Drift, jumps and flakiness in histories: what is found, and how often chance is taken for it.
#include "viewing/history/trends.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

HistoryLine line_with(int commit, double margin, const std::string& text = "stays upright") {
  HistoryLine line;
  line.stamp.commit = "c" + std::to_string(commit);
  line.scenario = "walk";
  line.code = "same";
  line.margins.push_back({text, margin, 1.0, 2.0, "rad", margin / 2.0, 7});
  return line;
}

/// A commit for each margin.
std::vector<HistoryLine> lines_of(const std::vector<double>& margins) {
  std::vector<HistoryLine> lines;
  for (const double margin : margins) lines.push_back(line_with(static_cast<int>(lines.size()), margin));
  return lines;
}

MarginTrend trend_of(const std::vector<double>& margins, const TrendOptions& options = {}) {
  return trends_of(lines_of(margins), options).margins.at(0);
}

std::vector<double> ten_steps(double factor) {
  std::vector<double> values{0.5};
  for (int i = 0; i < 10; ++i) values.push_back(values.back() * factor);
  return values;
}

/// Values around 1 with a relative deviation, by the seed.
std::vector<double> noise(std::uint64_t seed, std::size_t count, double deviation) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(1.0 + deviation * std::sqrt(-2.0 * std::log(uniform())) * std::cos(6.283185307179586 * uniform()));
  return values;
}

/// By hand: of the n! orders one falls throughout; 1, 3 and 5 of 3! = 6 have at least 3, 2 and 1 falling pairs.
TEST(ChanceOfFall, IsThatOfAllOrdersOfTheValues) {
  EXPECT_DOUBLE_EQ(chance_of_fall({3, 2, 1}), 1.0 / 6);
  EXPECT_DOUBLE_EQ(chance_of_fall({3, 1, 2}), 3.0 / 6);
  EXPECT_DOUBLE_EQ(chance_of_fall({1, 3, 2}), 5.0 / 6);
  EXPECT_DOUBLE_EQ(chance_of_fall({1, 2, 3}), 1.0);
  EXPECT_DOUBLE_EQ(chance_of_fall({5, 4, 3, 2, 1}), 1.0 / 120);
  EXPECT_NEAR(chance_of_fall({10, 9, 8, 7, 6, 5, 4, 3, 2, 1}), 1.0 / 3628800, 1e-18);
}

TEST(ChanceOfFall, IsOneWithoutTwoDifferentValues) {
  EXPECT_EQ(chance_of_fall({}), 1.0);
  EXPECT_EQ(chance_of_fall({4}), 1.0);
  EXPECT_EQ(chance_of_fall({4, 4, 4, 4}), 1.0);
}

/// S = 12 - 1 with continuity, of 15 pairs less 3 ties of three equal values: (6 5 17 - 3 2 11) / 18 = 24.67.
TEST(ChanceOfFall, WithTiesIsTheNormalApproximation) {
  EXPECT_NEAR(chance_of_fall({6, 5, 4, 3, 3, 3}), 0.5 * std::erfc(11.0 / std::sqrt(444.0 / 18.0) / std::sqrt(2.0)),
              1e-15);
}

/// Where the exact distribution ends, the approximation is close to it: S and its variance 60 59 125 / 18 by hand.
TEST(ChanceOfFall, HasNoStepWhereTheApproximationBegins) {
  std::vector<double> values = noise(3, 60, 1.0);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= 0.02 * static_cast<double>(i);
  double fall = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t k = i + 1; k < values.size(); ++k) fall += values[k] < values[i] ? 1.0 : -1.0;
  const double approximation = 0.5 * std::erfc((fall - 1.0) / std::sqrt(60.0 * 59.0 * 125.0 / 18.0) / std::sqrt(2.0));
  EXPECT_LT(approximation, 0.05);
  EXPECT_NEAR(chance_of_fall(values), approximation, 0.1 * approximation);
}

TEST(Drift, IsFoundInTenStepsOfTwoPercent) {
  const MarginTrend trend = trend_of(ten_steps(0.98));
  EXPECT_TRUE(trend.drifts);
  EXPECT_FALSE(trend.jump);
  EXPECT_EQ(drift_sentence(trend),
            "the margin of 'stays upright' of walk shrank in 10 of the last 10 commits, by 18.3 %");
}

TEST(Drift, IsFoundThoughOneStepGoesBack) {
  std::vector<double> values = ten_steps(0.97);
  values[4] = values[3] * 1.01;
  EXPECT_TRUE(trend_of(values).drifts);
  EXPECT_THAT(drift_sentence(trend_of(values)), HasSubstr("shrank in 9 of the last 10 commits, by 26.3 %"));
}

TEST(Drift, IsNoGrowthAndNoConstant) {
  EXPECT_FALSE(trend_of(ten_steps(1.02)).drifts);
  EXPECT_FALSE(trend_of(std::vector<double>(20, 0.25)).drifts);
}

TEST(Drift, IsNoChangeThatIsTooSmallToMatter) {
  EXPECT_FALSE(trend_of(ten_steps(0.9995)).drifts) << "0.5 %";
  EXPECT_TRUE(trend_of(ten_steps(0.9995), {.least_change = 0.001}).drifts);
}

TEST(Drift, IsJudgedOverTheLastCommitsAlone) {
  std::vector<double> values = ten_steps(0.98);
  values.insert(values.end(), 20, 0.6);  // it was mended
  EXPECT_FALSE(trend_of(values).drifts);
  EXPECT_EQ(trend_of(values, {.last = 5}).points.size(), 5U);
}

/// The stated rate is that of a whole history, here of four margins with 5 % of noise over 20 commits. Of 1,000 without
/// drift about 10 may drift; 20 are beyond three standard deviations.
TEST(Drift, IsFoundInAtMostOnePercentOfHistoriesWithoutOne) {
  int drifting = 0, jumping = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    std::vector<HistoryLine> lines = lines_of(noise(seed, 20, 0.05));
    for (const char* more : {"b", "c", "d"}) {
      const std::vector<double> values = noise(1000 * (static_cast<std::uint64_t>(*more)) + seed, 20, 0.05);
      for (std::size_t i = 0; i < values.size(); ++i)
        lines[i].margins.push_back({more, values[i], 1.0, 2.0, "rad", 0.5, 7});
    }
    const Trends trends = trends_of(lines);
    ASSERT_EQ(trends.margins.size(), 4U);
    drifting += trends.drifts();
    for (const MarginTrend& trend : trends.margins) jumping += trend.jump.has_value();
  }
  RecordProperty("drifting", drifting);
  RecordProperty("jumping", jumping);
  EXPECT_GT(drifting, 0) << "the test can find one";
  EXPECT_LE(drifting, 20);
  EXPECT_LE(jumping, 4) << "of 4,000 margins";
}

/// Ten steps of 2 % under noise of 2 %.
TEST(Drift, IsFoundUnderNoiseOfTheSizeOfAStep) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    std::vector<double> values = ten_steps(0.98);
    const std::vector<double> factors = noise(seed, values.size(), 0.02);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= factors[i];
    found += trend_of(values).drifts;
  }
  RecordProperty("found", found);
  EXPECT_GE(found, 950);
}

TEST(Jump, IsAtTheCommitBeforeWhichTheMarginFell) {
  const MarginTrend trend = trend_of({0.4, 0.41, 0.4, 0.39, 0.4, 0.41, 0.2, 0.21, 0.2, 0.19});
  ASSERT_TRUE(trend.jump);
  EXPECT_EQ(trend.points[*trend.jump].stamp.commit, "c6");
  EXPECT_FALSE(trend.drifts) << "a single step is no drift";
  EXPECT_EQ(jump_sentence(trend), "the margin of 'stays upright' of walk fell from 0.41 to 0.2 rad at c6");
}

TEST(Jump, OfAMarginThatIsElseConstantNeedsNoMeasureOfNoise) {
  EXPECT_EQ(trend_of({0.4, 0.4, 0.3}).jump, 2U);
  EXPECT_EQ(trend_of({0.4, 0.4, 0.4}).jump, std::nullopt);
  EXPECT_EQ(trend_of({0.4, 0.4, 0.3999}).jump, std::nullopt) << "less than 1 %";
  EXPECT_EQ(trend_of({0.4, 0.3}).jump, std::nullopt) << "one step has no other to compare with";
}

TEST(Jump, ToAGreaterMarginIsOneToo) {
  EXPECT_THAT(jump_sentence(trend_of({0.2, 0.2, 0.2, 0.4, 0.4})), HasSubstr("rose from 0.2 to 0.4 rad at c3"));
}

TEST(Points, OfOneCommitAreOneAndChangedFilesAreApart) {
  std::vector<HistoryLine> lines{line_with(0, 0.5), line_with(0, 0.4), line_with(1, 0.3), line_with(1, 0.2)};
  lines[3].stamp.changed = true;
  lines.push_back(line_with(2, 0.1));
  lines.back().stamp.commit.clear();
  lines.push_back(lines.back());
  const Trends trends = trends_of(lines);
  ASSERT_EQ(trends.margins.size(), 1U);
  std::vector<double> margins;
  for (const MarginPoint& point : trends.margins[0].points) margins.push_back(point.margin);
  EXPECT_THAT(margins, ElementsAre(0.4, 0.3, 0.2, 0.1, 0.1));
}

TEST(Points, AreInTheOrderOfDatesIfEachLineHasOne) {
  std::vector<HistoryLine> lines{line_with(0, 0.5), line_with(1, 0.4), line_with(2, 0.3)};
  lines[0].stamp.date = "2026-03-01";
  lines[1].stamp.date = "2026-02-01";
  EXPECT_EQ(trends_of(lines).margins[0].points[0].margin, 0.5);
  lines[2].stamp.date = "2026-01-01T10:00:00Z";
  EXPECT_EQ(trends_of(lines).margins[0].points[0].margin, 0.3);
}

TEST(Flaky, IsACommitWithTwoVerdictsAndUnchangedFiles) {
  std::vector<HistoryLine> lines{line_with(0, 0.5), line_with(0, 0.5), line_with(1, 0.5), line_with(1, 0.5)};
  lines[1].code = "controller.unsteady";
  lines[3].code = "controller.unsteady";
  lines[3].stamp.changed = true;
  const Trends trends = trends_of(lines);
  ASSERT_EQ(trends.flaky.size(), 1U);
  EXPECT_EQ(flaky_sentence(trends.flaky[0]), "walk has several verdicts at c0: same, controller.unsteady");
  EXPECT_THAT(verdict(trends), HasSubstr("no drift: 1 margin of 1 scenario; walk has several verdicts"));
}

TEST(Flaky, IsNotTheUnknownCommit) {
  std::vector<HistoryLine> lines{line_with(0, 0.5), line_with(0, 0.5)};
  for (HistoryLine& line : lines) line.stamp.commit.clear();
  lines[1].code = "physics.changed";
  EXPECT_TRUE(trends_of(lines).flaky.empty());
}

TEST(Sparkline, HasABlockForEachValue) {
  EXPECT_EQ(sparkline({0, 1, 2, 3, 4, 5, 6, 7}), "▁▂▃▄▅▆▇█");
  EXPECT_EQ(sparkline({3, 3}), "▅▅");
  EXPECT_EQ(sparkline({}), "");
}

}  // namespace
}  // namespace rehearse
