// Judgements: the values that a message states, and which of two equal margins decides.
#include <gtest/gtest.h>

#include "made_up_source.h"

namespace rehearse {
namespace {

Judged judged(const std::string& text, std::int64_t tick = 7) {
  MadeUpSource source;
  return Expression::parse(text, source)->judged(source, tick);
}

std::string words(const std::string& text, std::int64_t tick = 7) {
  MadeUpSource source;
  const Expression expression = *Expression::parse(text, source);
  return expression.comparison_text(expression.judged(source, tick).worst);
}

TEST(Judgements, StateTheValueOfTheBound) {
  EXPECT_EQ(words("force < 660 N"), "650 of 660 N");
  EXPECT_EQ(words("660 > force"), "650 of 660 N") << "whichever side it is on";
  EXPECT_EQ(words("q < Robot/KNEE/u"), "7 of 70") << "of two that vary, the right one is the bound";
  EXPECT_EQ(words("HEAD/pitch < 30 deg"), "28.6479 of 30 deg");
  EXPECT_EQ(words("HEAD/pitch < 0.6"), "0.5 of 0.6 rad");
  EXPECT_EQ(words("force < 0.7 * limit(KNEE, effort)"), "650 of 700 N");
}

TEST(Judgements, AreOfTheComparisonThatDecides) {
  EXPECT_EQ(words("force < 660 N && q < 8"), "7 of 8");
  EXPECT_EQ(words("force < 660 N || q < 8"), "650 of 660 N");
  EXPECT_EQ(words("!(force > 660 N)"), "650 of 660 N");
}

TEST(Judgements, OfEqualMarginsPreferTheOneThatDecides) {
  const Judged zero = judged("q <= 7 && q < 7");
  EXPECT_EQ(zero.worst.margin, 0.0);
  EXPECT_FALSE(zero.worst.truth);
  EXPECT_TRUE(judged("q < 7 || q <= 7").worst.truth);
}

TEST(Judgements, OfNaNAreUnknown) {
  const Judged judged_nan = judged("Robot/blank < 1");
  EXPECT_FALSE(judged_nan.holds);
  EXPECT_FALSE(judged_nan.worst.truth);
  EXPECT_TRUE(judged_nan.best.truth);
  EXPECT_TRUE(judged("!(Robot/blank < 1)").holds) << "as in C";
  EXPECT_FALSE(judged("!(Robot/blank < 1)").worst.truth);
  EXPECT_TRUE(judged("Robot/blank < 1 || q == 7").worst.truth);
}

TEST(Judgements, KnowWhetherAnythingIsCompared) {
  MadeUpSource source;
  EXPECT_TRUE(Expression::parse("contact(FOOT) && q < 1", source)->has_margin());
  EXPECT_TRUE(Expression::parse("!(q == 1) for 1 s", source)->has_margin());
  EXPECT_FALSE(Expression::parse("contact(FOOT) && nan(q)", source)->has_margin());
  EXPECT_FALSE(Expression::parse("(q < 1) == true", source)->has_margin());
}

}  // namespace
}  // namespace rehearse
