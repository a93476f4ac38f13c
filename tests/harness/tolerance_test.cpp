#include <gtest/gtest.h>
#include <rehearse/scenario.h>

#include <cmath>

#include "base/glob.h"

namespace rehearse {
namespace {

ToleranceRule rule(std::string channel, std::optional<double> atol, std::optional<double> rtol = std::nullopt) {
  ToleranceRule made;
  made.channel = std::move(channel);
  made.atol = atol;
  made.rtol = rtol;
  return made;
}

TEST(Tolerance, AStarMatchesAnyTextSlashesIncluded) {
  EXPECT_TRUE(matches("SR1/*/q", "SR1/RLEG_KNEE/q"));
  EXPECT_TRUE(matches("SR1/*/q", "SR1/SR1Minimum/input/RLEG_KNEE/q"));
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("a*b*c", "a--b-b--c"));
  EXPECT_FALSE(matches("SR1/*/q", "SR1/RLEG_KNEE/dq"));
  EXPECT_FALSE(matches("SR1/*/q", "SR10/RLEG_KNEE/q"));
  EXPECT_FALSE(matches("a*b", "ab-"));
}

TEST(Tolerance, AQuestionMarkAndBracketsMatchOnlyThemselves) {
  EXPECT_TRUE(matches("a?[b]", "a?[b]"));
  EXPECT_FALSE(matches("a?", "ab"));
}

TEST(Tolerance, ManyStarsAgainstALongNameTakeNoTime) {
  EXPECT_FALSE(matches("*a*a*a*a*a*a*a*a*a*a*a*a*b", std::string(5000, 'a')));
}

TEST(Tolerance, TheLastRuleThatMatchesDecides) {
  const std::vector<ToleranceRule> rules{rule("*", 1.0), rule("SR1/*/q", 2.0), rule("SR1/*/u", 3.0)};
  EXPECT_EQ(tolerance_of("SR1/KNEE/q", "rad", rules).atol, 2.0);
  EXPECT_EQ(tolerance_of("Box/BASE/position/x", "m", rules).atol, 1.0);
}

TEST(Tolerance, ARuleThatStatesOnlyRtolKeepsTheUnitsFloor) {
  const Tolerance tolerance = tolerance_of("SR1/KNEE/q", "rad", {rule("*", std::nullopt, 0.01)});
  EXPECT_EQ(tolerance.bound(0.0), 1e-9);
  EXPECT_EQ(tolerance.bound(2.0), 0.02);
}

TEST(Tolerance, NormalsMayRoundOtherwise) { EXPECT_EQ(default_tolerance("unit vector").bound(1.0), 1e-9); }

TEST(Tolerance, UnitsWithoutADefaultAreExact) {
  EXPECT_EQ(default_tolerance("").bound(1e6), 0.0);
  EXPECT_EQ(default_tolerance("lx").bound(1e6), 0.0);
}

TEST(Tolerance, PicturesMayRoundOtherwiseAndEdgesFallOnTheNextPixel) {
  EXPECT_EQ(default_tolerance("pixels").pixel_delta, 2.0);
  EXPECT_EQ(default_tolerance("pixels").pixel_share, 0.0005);
  EXPECT_DOUBLE_EQ(default_tolerance("depth").bound(10.0), 1e-2);
}

TEST(Tolerance, ARangeMayDifferByALastBitOfSinglePrecision) {
  const float range = 3.0F;
  EXPECT_GE(default_tolerance("range").bound(range), std::nextafter(range, 4.0F) - range);
  EXPECT_LT(default_tolerance("range").bound(range), 1e-6);
}

}  // namespace
}  // namespace rehearse
