#include <rehearse/compare.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "small_traces.h"

namespace rehearse {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Curve curve(std::vector<double> values, double step = 1.0) {
  Curve made;
  for (const double value : values) {
    made.times.push_back(step * static_cast<double>(made.times.size()));
    made.values.push_back(value);
  }
  return made;
}

/// Characters of the widest line.
std::size_t width_of(const std::string& text) {
  std::size_t widest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    widest = std::max(widest,
                      static_cast<std::size_t>(std::ranges::count_if(line, [](char c) { return (c & 0xc0) != 0x80; })));
  return widest;
}

TEST(SeriesPlot, ShowsBothCurvesAndWhereTheyPart) {
  EXPECT_EQ(plot(curve({0, 1, 2, 3, 3, 3, 3, 3, 3, 3}), curve({0, 1, 2, 3, 2, 1, 0, 0, 0, 0}), 4.0, {22, 4}),
            "         3 ┤   ▒░░░░░░\n"
            "           │  ▒ █\n"
            "           │ ▒   █\n"
            "         0 ┤▒     ████\n"
            "           └────▲─────\n"
            "            0 s    9 s\n");
}

TEST(SeriesPlot, NamesTheTimeOfTheDifferenceWhereThereIsRoom) {
  const std::string text = plot(curve({0, 0, 0, 0, 0}, 0.5), curve({0, 0, 1, 1, 1}, 0.5), 1.0, {60, 3});
  EXPECT_THAT(text, HasSubstr("▲"));
  EXPECT_THAT(text, ::testing::ContainsRegex("0 s +1 s +2 s\n"));
}

TEST(SeriesPlot, FitsItsWidthWhateverItDraws) {
  Curve noise;
  for (int i = 0; i < 10000; ++i) {
    noise.times.push_back(i * 1e-3);
    noise.values.push_back(std::sin(i * 0.7) * 1.23456789e-12);
  }
  for (const Curve& other : {noise, curve({1e300, -1e300}), curve({5.0})})
    for (const double mark : {0.0, 5.0, 1e9, -1.0}) EXPECT_LE(width_of(plot(noise, other, mark)), 78u);
}

TEST(SeriesPlot, OfOneLevelIsALineInTheMiddle) {
  EXPECT_THAT(plot(curve({7, 7}), curve({7, 7}), std::nullopt, {24, 3}), HasSubstr("\n           │▒▒▒▒▒▒▒▒▒▒▒▒\n"));
}

TEST(SeriesPlot, LeavesOutWhatIsNoFiniteNumber) {
  const std::string text = plot(curve({0, nan, 2, inf}), curve({0, 1, 2, -inf}), std::nullopt, {24, 3});
  EXPECT_THAT(text, HasSubstr("2 ┤"));
  EXPECT_THAT(plot(curve({nan}), curve({inf}), 0.0), HasSubstr("neither curve has a number that can be drawn"));
  EXPECT_THAT(plot({}, {}, std::nullopt), HasSubstr("neither curve has a number"));
}

TEST(SeriesPlot, EndsWhereACurveEnds) {
  const std::string text = plot(curve({1, 1}), curve({1, 1, 1, 1, 1, 1, 1, 1, 1, 1}), std::nullopt, {22, 2});
  EXPECT_THAT(text, HasSubstr("▒▒████████"));
}

TEST(SeriesPlot, OfARunShowsTheWorstSeriesOfTheWorstChannels) {
  const testing::TemporaryFolder folder;
  testing::SmallTrace run;
  run.ticks[1].u = 99.0;
  run.ticks[1].position[2] = 0.8;
  const Trace golden = testing::SmallTrace().load(folder / "a.mcap"), other = run.load(folder / "b.mcap");
  const Comparison comparison = compare(golden, other, {});
  const std::string all = worst_plots(golden, other, comparison, 3);
  EXPECT_THAT(all, HasSubstr("\n  Robot/Pd/output/KNEE/u [N·m]: ▒ both, ░ golden, █ run\n"));
  EXPECT_THAT(all, HasSubstr("\n  Robot/BASE/position/z [m]: ▒ both"));
  const std::string one = worst_plots(golden, other, comparison, 1);
  EXPECT_THAT(one, HasSubstr("Robot/BASE/position/z"));  // a hundred million times its tolerance
  EXPECT_THAT(one, Not(HasSubstr("KNEE/u")));
  EXPECT_THAT(worst_plots(golden, golden, compare(golden, golden, {}), 3), IsEmpty());
}

TEST(SeriesPlot, OfWhatWouldLookTheSameShowsTheDifference) {
  const testing::TemporaryFolder folder;
  testing::SmallTrace golden, run;
  golden.ticks[2].u = run.ticks[2].u = -12.0;
  run.ticks[1].u += 0.001;
  const Trace a = golden.load(folder / "a.mcap"), b = run.load(folder / "b.mcap");
  const std::string text = worst_plots(a, b, compare(a, b, {}), 1);
  EXPECT_THAT(text, HasSubstr("  Robot/Pd/output/KNEE/u [N·m]: run minus golden\n     0.001 ┤"));
  EXPECT_THAT(text, Not(HasSubstr("▒")));
}

TEST(SeriesPlot, ShowsEachStageBeforeASecondOfOne) {
  const testing::TemporaryFolder folder;
  testing::SmallTrace run;
  run.ticks[1].q = run.ticks[1].position[2] = 0.9;
  run.ticks[1].u = 12.1;  // a thousandth of the others' times their tolerance
  const Trace golden = testing::SmallTrace().load(folder / "a.mcap"), other = run.load(folder / "b.mcap");
  EXPECT_THAT(worst_plots(golden, other, compare(golden, other, {}), 2), HasSubstr("KNEE/u"));
}

TEST(SeriesPlot, OfARotationShowsTheNumberThatDiffersMost) {
  const testing::TemporaryFolder folder;
  testing::SmallTrace run;
  run.ticks[1].rotation = {0.0, 0.6, 0.0, 0.8};
  const Trace golden = testing::SmallTrace().load(folder / "a.mcap"), other = run.load(folder / "b.mcap");
  EXPECT_THAT(worst_plots(golden, other, compare(golden, other, {}), 3), HasSubstr("  Robot/BASE/orientation/y: "));
}

}  // namespace
}  // namespace rehearse
