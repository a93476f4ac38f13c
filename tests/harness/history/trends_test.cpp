// Drift, jumps and flakiness in histories: what is found, and how often chance is taken for it.
#include "viewing/history/trends.h"

#include <gmock/gmock.h>

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

TEST(Drift, IsNoneOfTwoCommitsThatShrinkTheMargin) {
  const MarginTrend trend = trend_of({0.5, 0.5, 0.5, 0.5, 0.49, 0.49, 0.49, 0.49, 0.48, 0.48, 0.48, 0.48});
  EXPECT_FALSE(trend.drifts) << trend.chance;
  EXPECT_DOUBLE_EQ(trend.chance, 0.25) << "one of four pairs of signs";
}

/// The largest step was once taken out before the test, so that the fall after it failed a margin that has grown.
TEST(Drift, IsNoneOfAMarginThatHasGrown) {
  const MarginTrend trend = trend_of({0.5, 0.5, 0.5, 0.5, 0.6, 0.6, 0.6, 0.6, 0.55, 0.55, 0.55, 0.55});
  EXPECT_FALSE(trend.drifts);
  std::vector<double> values = ten_steps(0.99);
  for (std::size_t i = 1; i < values.size(); ++i) values[i] += 0.2;
  EXPECT_FALSE(trend_of(values).drifts) << "it shrinks since, and is larger than at first";
}

TEST(Drift, IsNoneOfOneStepAmongChangesThatAreTooSmallToMatter) {
  std::vector<double> values = ten_steps(0.99999);
  for (std::size_t i = 5; i < values.size(); ++i) values[i] -= 0.1;
  const MarginTrend trend = trend_of(values);
  EXPECT_TRUE(trend.jump);
  EXPECT_LT(trend.chance, 0.001);
  EXPECT_FALSE(trend.drifts) << "without the step it shrank by 0.1 %";
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
