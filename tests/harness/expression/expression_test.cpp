// Expressions: their values, and the messages about invalid ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/expression/expression.h"
#include "made_up_source.h"

namespace rehearse {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ExpressionOf : public ::testing::Test {
 protected:
  Expression parsed(const std::string& text) {
    auto expression = Expression::parse(text, source);
    if (expression) return *std::move(expression);
    ADD_FAILURE() << with_caret(expression.errors().front(), text);
    return *Expression::parse("0", source);
  }
  double number(const std::string& text, std::int64_t tick = 7) {
    const Expression expression = parsed(text);
    EXPECT_EQ(expression.type(), Expression::Type::number) << text;
    return expression.number(source, tick);
  }
  bool holds(const std::string& text, std::int64_t tick = 7) {
    const Expression expression = parsed(text);
    EXPECT_EQ(expression.type(), Expression::Type::boolean) << text;
    return expression.type() == Expression::Type::boolean && expression.holds(source, tick);
  }
  MadeUpSource source;
};

TEST_F(ExpressionOf, ArithmeticBindsAsInC) {
  EXPECT_EQ(number("1 + 2 * 3"), 7.0);
  EXPECT_EQ(number("(1 + 2) * 3"), 9.0);
  EXPECT_EQ(number("10 - 4 - 3"), 3.0);
  EXPECT_EQ(number("12 / 3 / 2"), 2.0);
  EXPECT_EQ(number("12/3"), 4.0) << "numbers need no blanks";
  EXPECT_EQ(number("-2 * -3"), 6.0);
  EXPECT_EQ(number("1e-3 + .5"), 0.501);
}

TEST_F(ExpressionOf, AnglesInDegreesAreInRadians) {
  EXPECT_DOUBLE_EQ(number("180 deg"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(number("90deg / 2"), std::numbers::pi / 4);
  EXPECT_EQ(number("1 rad"), 1.0);
}

TEST_F(ExpressionOf, SeriesAreFoundByTheirNameOrAnEndingOfIt) {
  EXPECT_EQ(number("Robot/KNEE/q"), 7.0);
  EXPECT_EQ(number("KNEE/q"), 7.0);
  EXPECT_EQ(number("q"), 7.0);
  EXPECT_EQ(number("Robot/KNEE/u"), 70.0) << "a whole name is meant, though another ends like it";
  EXPECT_EQ(number("output/KNEE/u"), 5.0);
  EXPECT_EQ(number("'odd name-1/x' + 1"), 2.0);
  EXPECT_EQ(number("\"Robot/odd name-1/x\""), 1.0);
}

TEST_F(ExpressionOf, ADivisionOfSeriesHasBlanks) { EXPECT_EQ(number("Robot/KNEE/u / Robot/KNEE/q"), 10.0); }

TEST_F(ExpressionOf, TicksAndTimesAreNumbers) {
  EXPECT_EQ(number("tick"), 7.0);
  EXPECT_EQ(number("time"), 0.007);
}

TEST_F(ExpressionOf, TicksInWhichControllersDiffer) {
  EXPECT_FALSE(holds("differs", 2));
  EXPECT_TRUE(holds("differs && !prev(differs)", 3));
}

TEST_F(ExpressionOf, FunctionsOfNumbers) {
  EXPECT_EQ(number("abs(-3) + min(1, 2) + max(1, 2) + sqrt(16)"), 10.0);
  EXPECT_EQ(number("sin(0) + cos(0)"), 1.0);
  EXPECT_TRUE(std::isnan(number("min(1, Robot/blank)")));
  EXPECT_TRUE(std::isnan(number("max(Robot/blank, 1)")));
}

TEST_F(ExpressionOf, AndBindsTighterThanOr) {
  EXPECT_TRUE(holds("true || false && false"));
  EXPECT_FALSE(holds("(true || false) && false"));
  EXPECT_TRUE(holds("!false && 1 < 2"));
  EXPECT_TRUE(holds("(1 < 2) == true"));
}

TEST_F(ExpressionOf, ComparisonsWithNaNAreFalse) {
  for (const char* symbol : {"<", "<=", ">", ">=", "=="})
    EXPECT_FALSE(holds(std::string("Robot/blank ") + symbol + " 0"));
  EXPECT_TRUE(holds("Robot/blank != 0"));
  EXPECT_TRUE(holds("nan(Robot/blank)"));
  EXPECT_FALSE(holds("nan(q)"));
}

TEST_F(ExpressionOf, TheTickBefore) {
  EXPECT_EQ(number("prev(q)"), 6.0);
  EXPECT_EQ(number("prev(prev(q) + 1)"), 6.0);
  EXPECT_EQ(number("delta(Robot/KNEE/u)"), 10.0);
  EXPECT_TRUE(holds("changed(q)"));
  EXPECT_FALSE(holds("changed(output/KNEE/u)"));
  EXPECT_FALSE(holds("changed(Robot/blank)")) << "NaN that stays NaN";
  EXPECT_TRUE(holds("changed(contact(FOOT))"));
}

TEST_F(ExpressionOf, NothingIsBeforeTheFirstTick) {
  EXPECT_TRUE(std::isnan(number("prev(q)", 0)));
  EXPECT_TRUE(std::isnan(number("delta(q)", 0)));
  EXPECT_FALSE(holds("changed(q)", 0));
  EXPECT_FALSE(holds("prev(true)", 0));
}

TEST_F(ExpressionOf, NumbersHaveUnits) {
  EXPECT_TRUE(holds("force == 0.65 kN"));
  EXPECT_TRUE(holds("force == 650 N && force < 651"));
  EXPECT_TRUE(holds("time == 7 ms && time < 1 s"));
  EXPECT_DOUBLE_EQ(number("90 deg/s"), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(number("90 deg/2"), std::numbers::pi / 4) << "a division";
  EXPECT_EQ(number("3 m + 5 mm"), 3.005);
  EXPECT_DOUBLE_EQ(number("20 uT"), 2e-5);
  EXPECT_DOUBLE_EQ(number("250 mrad"), 0.25);
  EXPECT_TRUE(holds("force / force < 2 && 2 * force < 1.5 kN && sqrt(force) < 26"));
  EXPECT_TRUE(holds("force < 0.7 * limit(KNEE, effort)"));
  EXPECT_FALSE(Expression::parse("force < 2 N·m", source));
}

TEST_F(ExpressionOf, JointsHaveSeriesAndLimits) {
  EXPECT_EQ(number("q(KNEE)"), 7.0);
  EXPECT_EQ(number("u(Robot/KNEE)"), 70.0);
  EXPECT_EQ(number("u_target(KNEE)"), 5.0);
  EXPECT_EQ(number("limit(KNEE, effort)"), 1000.0);
}

TEST_F(ExpressionOf, LinksHavePositionsAndAngles) {
  EXPECT_EQ(number("HEAD/z"), 1.5);
  EXPECT_NEAR(number("HEAD/roll"), 0.0, 1e-12);
  EXPECT_NEAR(number("Robot/HEAD/pitch"), 0.5, 1e-12);
  EXPECT_NEAR(number("HEAD/yaw"), 0.0, 1e-12);
  EXPECT_TRUE(holds("HEAD/pitch < 29 deg && HEAD/pitch > 28 deg"));
}

TEST_F(ExpressionOf, AStepIsAJump) {
  EXPECT_TRUE(holds("step(replayed(output/KNEE/u))", 3));
  EXPECT_FALSE(holds("step(replayed(output/KNEE/u))", 4));
  EXPECT_FALSE(holds("step(q)", 7)) << "it grows evenly";
  EXPECT_TRUE(holds("step(Robot/KNEE/u, 9)", 7));
  EXPECT_FALSE(holds("step(Robot/KNEE/u, 11)", 7));
  EXPECT_FALSE(holds("step(q)", 0)) << "nothing is before it";
}

TEST_F(ExpressionOf, ASeriesIsTakenAtATime) {
  EXPECT_EQ(number("q - at(q, 5 ms)"), 2.0);
  EXPECT_TRUE(std::isnan(number("at(q, 9 ms)", 7))) << "that is later";
}

TEST_F(ExpressionOf, AConditionLastsForATime) {
  EXPECT_TRUE(holds("q < 10 for 2 ms", 7));
  EXPECT_FALSE(holds("q < 10 for 3 ms", 7));
  EXPECT_TRUE(holds("!(q < 10 for 3 ms) && q < 8", 7));
  EXPECT_TRUE(holds("(q > 1 && q < 10) for 1 ms for 1 ms", 7));
  EXPECT_FALSE(holds("q > 1 for 2 ms", MadeUpSource::last)) << "the end is not after it";
}

TEST_F(ExpressionOf, AQuoteInAnotherIsDoubled) {
  EXPECT_FALSE(holds("message('it''s')", 20));
  EXPECT_TRUE(holds("event(\"note Robot: st*\")", 20));
}

TEST_F(ExpressionOf, CommandsAsRecordedAndAsReplayed) {
  EXPECT_EQ(number("recorded(output/KNEE/u)"), 5.0);
  EXPECT_EQ(number("replayed(output/KNEE/u)"), 6.0);
  EXPECT_TRUE(holds("recorded(output/KNEE/u) == replayed(output/KNEE/u)", 2));
}

TEST_F(ExpressionOf, ContactsAndMessages) {
  EXPECT_TRUE(holds("contact(FOOT)", 8));
  EXPECT_FALSE(holds("contact(FOOT)", 7));
  EXPECT_FALSE(holds("contact(HEAD)", 8));
  EXPECT_TRUE(holds("contact(Robot)", 8)) << "any link of a body";
  EXPECT_TRUE(holds("contact('Floor/Floor', FOOT)", 8));
  EXPECT_FALSE(holds("contact(HEAD, FOOT)", 8));
  EXPECT_TRUE(holds("message(\"st*\")", 20));
  EXPECT_FALSE(holds("message('fall')", 20));
  EXPECT_FALSE(holds("message('st*')", 21));
}

TEST_F(ExpressionOf, TellsWhatItIsMadeOf) {
  const Expression expression = parsed("Robot/KNEE/u > 100 && contact(FOOT) && Robot/KNEE/u < time");
  std::vector<std::string> texts;
  for (const Expression::Operand& operand : expression.operands()) texts.push_back(operand.text);
  EXPECT_THAT(texts, ElementsAre("Robot/KNEE/u", "contact(FOOT)"));
  EXPECT_EQ(expression.number_of(expression.operands().front(), source, 7), 70.0);
}

struct Mistake {
  const char* text;
  int column;
  const char* says;
};
class ExpressionMistake : public ExpressionOf, public ::testing::WithParamInterface<Mistake> {};

TEST_P(ExpressionMistake, IsToldWithItsPlace) {
  const auto expression = Expression::parse(GetParam().text, source);
  ASSERT_FALSE(expression.ok()) << GetParam().text;
  ASSERT_EQ(expression.errors().size(), 1u);
  const Diagnostic& found = expression.errors().front();
  EXPECT_EQ(found.column, GetParam().column) << with_caret(found, GetParam().text);
  EXPECT_THAT(to_string(found), HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Of, ExpressionMistake,
    ::testing::Values(
        Mistake{"", 1, "nothing in this expression"}, Mistake{"  ", 1, "nothing in this expression"},
        Mistake{"KNEEE/q > 1", 1, "there is no series 'KNEEE/q' (did you mean 'KNEE/q'"},
        Mistake{"1 + KNEE/u", 5, "'KNEE/u' may be one of 2 series (Robot/KNEE/u, Robot/Walker/output/KNEE/u)"},
        Mistake{"time/2", 1, "if it is a division, put blanks around the /"},
        Mistake{"q > 1 &&", 9, "ends where a value is expected"}, Mistake{"(q > 1", 1, "this parenthesis isn't closed"},
        Mistake{"q > 1)", 6, "this parenthesis was never opened"},
        Mistake{"q > 1 q", 7, "the expression should end before 'q'"}, Mistake{"q = 1", 3, "equality is written =="},
        Mistake{"q > 1 & true", 7, "and is written &&"}, Mistake{"q > 1 | true", 7, "or is written ||"},
        Mistake{"q ; 1", 3, "';' has no meaning here"}, Mistake{"* 2", 1, "expected a value before '*'"},
        Mistake{"q + contact(FOOT)", 5, "+ takes a number, and this is true or false"},
        Mistake{"q && true", 1, "&& takes true or false, and this is a number (compare it: x != 0)"},
        Mistake{"!q", 2, "! takes true or false"}, Mistake{"-(q > 1)", 3, "- takes a number"},
        Mistake{"1 < true", 5, "< takes a number"}, Mistake{"true < 1", 1, "< takes a number"},
        Mistake{"(q > 1) == 2", 12, "== takes true or false"}, Mistake{"1 < q < 3", 7, "comparisons can't be chained"},
        Mistake{"abs(true)", 5, "abs takes a number"},
        Mistake{"min(1)", 6, "expected ',' in min: it takes two numbers"},
        Mistake{"abs(1, 2)", 6, "expected ')' after the arguments of abs"},
        Mistake{"median(1)", 1, "there is no function 'median'"}, Mistake{"delta(true)", 7, "delta takes a number"},
        Mistake{"prev(prev(prev(prev(prev(q)))))", 21, "at most 4 in each other"},
        Mistake{"step(prev(step(prev(q))))", 11, "at most 4 ticks back"},
        Mistake{"q(KNEEE) > 1", 3, "there is no joint 'KNEEE' with q (known joints: Robot/KNEE)"},
        Mistake{"q(1) > 1", 3, "q takes the name of a joint"},
        Mistake{"limit(KNEE, effortt)", 13, "there is no limit 'effortt' (expected effort, velocity"},
        Mistake{"limit(NECK, effort)", 7, "there is no joint 'NECK' with a limit"},
        Mistake{"limit(KNEE)", 11, "expected ',' in limit"},
        Mistake{"force > 1 m", 9, "> takes numbers of one unit, and these are in N and m"},
        Mistake{"force + time", 9, "+ takes numbers of one unit, and these are in N and s"},
        Mistake{"max(force, 2 deg)", 12, "max takes numbers of one unit, and these are in N and rad"},
        Mistake{"q > 1 for 2 m", 11, "expected a time after 'for'"},
        Mistake{"q > 1 for", 10, "expected a time after 'for'"}, Mistake{"q for 1 s", 1, "for takes true or false"},
        Mistake{"prev(q > 1 for 1 s)", 6, "prev takes a value of one tick"},
        Mistake{"(q > 1 for 1 s) == true", 2, "== takes a value of one tick"},
        Mistake{"at(q)", 5, "expected ',' in at"}, Mistake{"at(1, 1 s)", 4, "at takes the name of a series"},
        Mistake{"event(step)", 7, "event takes a text in quotes"},
        Mistake{"replayed(q)", 10, "there is only one value of this"},
        Mistake{"recorded(1)", 10, "takes the name of a command"},
        Mistake{"contact(FOOOT)", 9, "there is no link 'FOOOT' (did you mean 'FOOT'?)"},
        Mistake{"contact()", 9, "contact takes the names of one or two links"},
        Mistake{"message(step)", 9, "message takes a text in quotes"},
        Mistake{"'KNEE/q > 1", 1, "this quote isn't closed"}, Mistake{"3 + 5mx", 6, "'mx' is no unit"},
        Mistake{"1e999", 1, "beyond the range of a double"}, Mistake{"'ö' + q", 1, "there is no series"},
        Mistake{"1 + \x01", 5, "the byte 0x01 has no meaning here"}));

TEST_F(ExpressionOf, ACaretStandsUnderThePlace) {
  const std::string text = "KNEE/q > 1 && KNEEE/q < 2";
  const auto expression = Expression::parse(text, source);
  ASSERT_FALSE(expression.ok());
  EXPECT_EQ(with_caret(expression.errors().front(), text),
            "error: there is no series 'KNEEE/q' (did you mean 'KNEE/q' or 'KNEE/u'?)\n"
            "  KNEE/q > 1 && KNEEE/q < 2\n"
            "                ^\n");
}

TEST_F(ExpressionOf, ACaretCountsCharactersAndNotBytes) {
  const std::string text = "message('größer')\t&& x";
  const auto expression = Expression::parse(text, source);
  ASSERT_FALSE(expression.ok());
  EXPECT_THAT(with_caret(expression.errors().front(), text),
              HasSubstr("\n  message('größer') && x\n                       ^\n"));
}

TEST_F(ExpressionOf, IsRefusedIfItIsTooDeepOrTooLong) {
  for (const std::string& text :
       {std::string(4000, '('), std::string(4000, '!') + "true", std::string(4000, '-') + "1"}) {
    const auto expression = Expression::parse(text, source);
    ASSERT_FALSE(expression.ok());
    EXPECT_THAT(expression.errors().front().message, HasSubstr("more than 100 deep"));
  }
  const auto expression = Expression::parse(std::string(100'000, '('), source);
  ASSERT_FALSE(expression.ok());
  EXPECT_THAT(expression.errors().front().message, HasSubstr("at most 4096 bytes"));
}

TEST_F(ExpressionOf, LongChainsAreComputed) {
  std::string text = "1";
  while (text.size() + 2 < Expression::longest) text += "+1";
  EXPECT_EQ(number(text), static_cast<double>((text.size() + 1) / 2));
}

}  // namespace
}  // namespace rehearse
