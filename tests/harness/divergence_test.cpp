#include <gtest/gtest.h>
#include <rehearse/compare.h>

#include <cmath>
#include <limits>

namespace rehearse {
namespace {

constexpr double any_nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t most_ulps = std::numeric_limits<std::uint64_t>::max();

Divergence between(double expected, double actual) {
  Divergence divergence;
  put_numbers(divergence, expected, actual, "N");
  return divergence;
}

TEST(Divergence, OfTwoNumbersHasTheirDifferenceAndTheirUlps) {
  const Divergence divergence = between(1.0, std::nextafter(1.0, 0.0));
  EXPECT_EQ(divergence.expected, 1.0);
  EXPECT_EQ(divergence.actual, std::nextafter(1.0, 0.0));
  EXPECT_EQ(divergence.difference, 0x1p-53);
  EXPECT_EQ(divergence.ulps, 1u);
  EXPECT_EQ(divergence.unit, "N");
}

TEST(Divergence, OfZerosOfBothSignsIsZero) {
  EXPECT_EQ(between(0.0, -0.0).difference, 0.0);
  EXPECT_EQ(between(0.0, -0.0).ulps, 0u);
}

TEST(Divergence, OfOneNanIsNanAndOfTwoIsZero) {
  EXPECT_TRUE(std::isnan(between(any_nan, 1.0).difference));
  EXPECT_TRUE(std::isnan(between(1.0, any_nan).difference));
  EXPECT_EQ(between(any_nan, -any_nan).difference, 0.0);
  EXPECT_EQ(between(any_nan, -any_nan).ulps, most_ulps);
}

TEST(Divergence, CollectionKeepsTheFirstTheWorstAndTheFirstBeyond) {
  Differences differences;
  for (const double actual : {1.1, 1.5, 1.9, 1.7}) {
    Divergence divergence = between(1.0, actual);
    divergence.tolerance = 0.2;
    differences.add(divergence);
  }
  EXPECT_EQ(differences.values_different, 4);
  EXPECT_EQ(differences.first->actual, 1.1);
  EXPECT_EQ(differences.worst->actual, 1.9);
  EXPECT_EQ(differences.beyond->actual, 1.5);
}

TEST(Divergence, WithANoteIsBeyondAnyTolerance) {
  Differences differences;
  Divergence divergence = between(1.0, 1.0);
  divergence.tolerance = 1.0;
  divergence.note = "missing";
  differences.add(divergence);
  EXPECT_TRUE(differences.beyond);
}

TEST(Divergence, OfANumberFromNanIsBeyondAnyTolerance) {
  Differences differences;
  Divergence divergence = between(1.0, any_nan);
  divergence.tolerance = 1.0;
  differences.add(divergence);
  EXPECT_TRUE(differences.beyond);
}

}  // namespace
}  // namespace rehearse
