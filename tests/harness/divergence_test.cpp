#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rehearse/compare.h>

#include <cmath>
#include <limits>

#include "core/compare/divergence_text.h"

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

/// A command of one joint.
Divergence command(std::int64_t tick, double expected, double actual, double tolerance) {
  Divergence divergence;
  put_numbers(divergence, expected, actual, "N·m");
  divergence.channel = "/Arm/Hold/output/joints";
  divergence.element = "SHOULDER/u";
  divergence.tick = tick;
  divergence.time = 0.001 * static_cast<double>(tick);
  divergence.tolerance = tolerance;
  return divergence;
}

TEST(Divergence, BeyondAToleranceIsNamedWithTheWorstOfItsChannel) {
  const Divergence first = command(512, 1.0, 1.0011, 0.001), worst = command(739, 1.0, 1.0136, 0.001);
  EXPECT_EQ(
      headline_of(first, worst, {.when = when_text(first)}),
      "Arm/Hold/output/SHOULDER/u is beyond ±0.001 N·m from tick 512 (0.512 s) on, worst 0.0136 N·m (14 times) at "
      "tick 739");
  Divergence elbow = worst;
  elbow.element = "ELBOW/u";
  EXPECT_EQ(headline_of(first, elbow, {.when = "tick 512", .before_beyond = "differs: ", .name = "SHOULDER/u"}),
            "differs: SHOULDER/u is beyond ±0.001 N·m from tick 512 on; worst is ELBOW/u by 0.0136 N·m "
            "(14 times) at tick 739");
  EXPECT_EQ(headline_of(first, std::nullopt, {.when = "tick 512", .name = "SHOULDER/u"}),
            "SHOULDER/u is beyond ±0.001 N·m from tick 512 on")
      << "the worst isn't known";
}

TEST(Divergence, WithoutAToleranceIsNamedByItsPlaceAndBothValues) {
  const Divergence exact = command(3, 1.0, 2.0, 0.0);
  EXPECT_EQ(headline_of(exact, exact, {.when = "tick 3", .before_differs = "the world "}),
            "the world differs at tick 3: /Arm/Hold/output/joints SHOULDER/u is 2 N·m, expected 1 N·m: off by 1 N·m "
            "(stage: controller)");
}

TEST(Divergence, HasUlpsInWordsOnlyIfTheyAreFew) {
  const Divergence last_bit = command(3, 1.0, std::nextafter(1.0, 2.0), 0.0), other = command(3, 1.0, 2.0, 0.0);
  EXPECT_THAT(to_string(last_bit), ::testing::HasSubstr("(relative 2.22e-16, 1 ULP; stage: controller)"));
  EXPECT_THAT(to_string(other), ::testing::Not(::testing::HasSubstr("ULP")));
  EXPECT_THAT(describe_in_full(other, "tick 3"), ::testing::HasSubstr("(relative 1, 4.5e+15 ULPs; stage"));
  EXPECT_EQ(few_ulps_text(999), "999 ULPs");
  EXPECT_EQ(few_ulps_text(1000), "");
}

TEST(Divergence, IsWorseByMultiplesOfItsTolerance) {
  EXPECT_TRUE(is_worse(command(0, 0.0, 1.0, 0.1), command(0, 0.0, 5.0, 1.0)));
  EXPECT_TRUE(is_worse(command(0, 0.0, 5.0, 1.0), command(0, 0.0, 9.0, 0.0))) << "without one: as at a tolerance";
  EXPECT_TRUE(is_worse(command(0, 0.0, 9.0, 0.0), command(0, 0.0, 8.0, 0.0)));
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
