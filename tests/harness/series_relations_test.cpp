// Relations between series of two runs, which explain their differences.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/compare/series_relations.h"

namespace rehearse {
namespace {

using Function = std::function<double(int)>;

constexpr int length = 100;

double wave(int i) { return std::sin(0.3 * i); }
double other_wave(int i) { return std::cos(0.17 * i) + 0.4; }

PairedSeries series(std::string name, const Function& recorded, const Function& present) {
  PairedSeries made{std::move(name), {}, {}, {}};
  for (int i = 0; i < length; ++i) {
    made.ticks.push_back(10 * i);
    made.recorded.push_back(recorded(i));
    made.present.push_back(present(i));
  }
  return made;
}

std::string explained(const std::vector<PairedSeries>& all) { return to_string(find_relations(all), all); }

TEST(SeriesRelations, NamesThePermutedOrder) {
  EXPECT_EQ(explained({series("a", wave, other_wave), series("b", other_wave, wave)}),
            "the order differs: a has the recorded values of b, b has the recorded values of a, in all 100 values");
}

TEST(SeriesRelations, NamesThePermutedOrderBesideAnotherZero) {
  EXPECT_EQ(explained({series("a", wave, [](int i) { return other_wave(i) + 0.7; }),
                       series("b", other_wave, [](int i) { return wave(i) - 0.7; })}),
            "the order differs: a has the recorded values of b + 0.7, b has the recorded values of a - 0.7, in all 100 "
            "values");
}

TEST(SeriesRelations, DistinguishesAPermutationFromAnotherSource) {
  EXPECT_EQ(explained({series("a", wave, other_wave), series("b", other_wave, other_wave)}),
            "another series is taken: a has the recorded values of b, in all 100 values");
}

TEST(SeriesRelations, NamesTheScale) {
  EXPECT_EQ(explained({series("speed", wave, [](int i) { return 20.0 * wave(i); })}),
            "the scale differs: speed is 20 times the recorded one, in all 100 values");
  EXPECT_EQ(explained({series("speed", wave, [](int i) { return -wave(i); })}),
            "the scale differs: speed is -1 times the recorded one, in all 100 values");
}

TEST(SeriesRelations, NamesTheZero) {
  EXPECT_EQ(explained({series("angle", wave, [](int i) { return wave(i) - 1.3; })}),
            "the zero differs: angle is the recorded one - 1.3, in all 100 values");
}

TEST(SeriesRelations, NamesTheDelay) {
  EXPECT_EQ(explained({series("angle", wave, [](int i) { return wave(i - 1); })}),
            "it is late: angle is the recorded one of 1 value before, in all 100 values");
  EXPECT_EQ(explained({series("angle", wave, [](int i) { return wave(i + 2); })}),
            "it is early: angle is the recorded one of 2 values after, in all 100 values");
}

TEST(SeriesRelations, NamesAStaleCopyOfAnotherSeriesThatDiffersItself) {
  const Function recorded = [](int i) { return i < 0 ? 0.0 : std::cos(0.3 * i); };
  const Function present = [](int i) { return i < 0 ? 0.0 : std::cos(0.31 * i + 0.001 * i * i); };
  const auto after = [](const Function& f, int steps) { return [=](int i) { return f(i - steps); }; };
  EXPECT_EQ(
      explained({series("action", recorded, present), series("last_action", after(recorded, 1), after(present, 2))}),
      "it is stale: last_action is action of 2 values before, in the recording of 1 value before, in all 100 "
      "values");
}

TEST(SeriesRelations, CountsTheSeriesThatItDoesNotName) {
  std::vector<PairedSeries> all;
  for (int n = 0; n < 5; ++n)
    all.push_back(series(
        std::string(1, static_cast<char>('a' + n)), [n](int i) { return wave(i * (n + 2)); },
        [n](int i) { return 2.0 * wave(i * (n + 2)); }));
  EXPECT_EQ(
      explained(all),
      "the scale differs: a is 2 times the recorded one, b is 2 times the recorded one, c is 2 times the recorded "
      "one, and 2 more likewise, in all 100 values");
}

TEST(SeriesRelations, StatesThatItSawAPart) {
  const std::vector<PairedSeries> part{series("a", wave, [](int i) { return 2.0 * wave(i); })};
  EXPECT_EQ(to_string(find_relations(part), part, false),
            "the scale differs: a is 2 times the recorded one, in the first 100 values");
}

TEST(SeriesRelations, IgnoresLastBits) {
  EXPECT_EQ(explained({series("a", wave, [](int i) { return wave(i) * (1.0 + 1e-15); })}), "");
  EXPECT_EQ(explained({series("a", wave, [](int i) { return 3.0 * wave(i) * (1.0 + 1e-12 * i); })}),
            "the scale differs: a is 3 times the recorded one, in all 100 values");
}

TEST(SeriesRelations, NamesNothingThatHoldsInSomeValuesOnly) {
  EXPECT_EQ(explained({series("a", wave, [](int i) { return i == 70 ? 0.5 : 2.0 * wave(i); })}), "");
}

TEST(SeriesRelations, NamesNothingOfSeriesThatHardlyChange) {
  const Function step = [](int i) { return i < 50 ? 0.0 : 1.0; };
  EXPECT_EQ(explained({series("a", step, [=](int i) { return 2.0 * step(i); })}), "");
  EXPECT_EQ(explained({series(
                "a", [](int) { return 1.0; }, [](int) { return 2.0; })}),
            "");
}

TEST(SeriesRelations, NamesNothingIfTwoRelationsFit) {
  const Function twice = [](int i) { return 2.0 * wave(i); };
  EXPECT_EQ(explained({series("a", wave, twice), series("b", twice, twice)}), "");  // scaled, or another source
}

TEST(SeriesRelations, NamesNothingThatMayBeAConsequence) {
  const Function late = [](int i) { return i < 20 ? other_wave(i) : 2.0 * other_wave(i); };
  const Function scaled = [](int i) { return i < 30 ? 0.0 : 3.0 * wave(i); };
  const Function from_30 = [](int i) { return i < 30 ? 0.0 : wave(i); };
  EXPECT_EQ(explained({series("a", other_wave, late), series("b", from_30, scaled)}), "");
  EXPECT_NE(explained({series("b", from_30, scaled)}), "");
}

TEST(SeriesRelations, NamesNothingOfNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(explained({series("a", wave, [=](int i) { return i == 3 ? nan : 2.0 * wave(i); })}), "");
  EXPECT_EQ(explained({series("a", wave, [=](int) { return nan; })}), "");
}

TEST(SeriesRelations, ComparesSeriesOfTheSameTicksOnly) {
  PairedSeries shorter = series("b", other_wave, wave);
  shorter.ticks.pop_back();
  shorter.recorded.pop_back();
  shorter.present.pop_back();
  EXPECT_EQ(explained({series("a", wave, other_wave), shorter}), "");
  EXPECT_EQ(explained({}), "");
}

}  // namespace
}  // namespace rehearse
