// Formulas on one run of ten ticks, with their truth and margin by hand: every operator, and every edge.
//
// tick    0    1    2    3    4    5    6    7    8    9
// time    0.0  0.1  0.2  0.3  0.4  0.5  0.6  0.7  0.8  0.9 s
// a       1    2    3    4    5    4    3    2    1    0   m
// b       0    0    0    5    5    0    0    0    0    0   m
// c       -1   1    -1   1    -1   1    -1   1    -1   1   m
// n       1    1    1    NaN  1    1    1    1    1    1   m
// foot    .    .    #    #    .    .    #    .    .    .
#include <gtest/gtest.h>

#include <ostream>

#include "sampled_source.h"

namespace rehearse {
namespace {

using testing::FormulaText;
using testing::SampledSource;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr Quantifier always = Quantifier::always, eventually = Quantifier::eventually, never = Quantifier::never;
using State = FormulaResult::State;
constexpr State holds = State::holds, violated = State::violated, undecided = State::undecided;

SampledSource ten_ticks() {
  SampledSource source;
  for (std::uint64_t i = 0; i < 10; ++i) source.times.push_back(i * 100'000'000);
  source.series["a"] = {1, 2, 3, 4, 5, 4, 3, 2, 1, 0};
  source.series["b"] = {0, 0, 0, 5, 5, 0, 0, 0, 0, 0};
  source.series["c"] = {-1, 1, -1, 1, -1, 1, -1, 1, -1, 1};
  source.series["n"] = {1, 1, 1, none, 1, 1, 1, 1, 1, 1};
  source.foot = {false, false, true, true, false, false, true, false, false, false};
  return source;
}

struct Row {
  FormulaText formula;
  State state;
  double margin;        // NaN: none
  double at = -1.0;     // time of the margin [s]; -1: any
  bool is_nan = false;  // violated because of NaN
  double first = -1.0;  // the first violation [s]; -1: any
};

std::ostream& operator<<(std::ostream& stream, const Row& row) {
  const FormulaText& f = row.formula;
  stream << (f.quantifier == always ? "always " : f.quantifier == never ? "never " : "eventually ") << f.condition;
  if (!f.after.empty()) stream << " after " << f.after;
  if (!f.except.empty()) stream << " except " << f.except;
  if (f.within) stream << " within " << *f.within;
  if (f.lasting) stream << " for " << *f.lasting;
  if (f.from) stream << " from " << *f.from;
  if (f.until) stream << " until " << *f.until;
  return stream;
}

class FormulaTable : public ::testing::TestWithParam<Row> {};

TEST_P(FormulaTable, HasTheTruthAndMarginOfItsDefinition) {
  const Row& row = GetParam();
  SampledSource source = ten_ticks();
  const FormulaResult result = testing::judged(row.formula, source);
  EXPECT_EQ(result.state, row.state);
  EXPECT_EQ(result.is_nan, row.is_nan);
  ASSERT_EQ(result.decisive.has_value(), !std::isnan(row.margin));
  if (result.decisive) {
    EXPECT_DOUBLE_EQ(result.decisive->judgement.margin, row.margin);
  }
  if (row.at >= 0.0) {
    EXPECT_EQ(result.decisive->judgement.time, testing::in_ns(row.at));
  }
  if (row.first >= 0.0) {
    EXPECT_EQ(result.first->time, testing::in_ns(row.first));
  }
}

FormulaText of(Quantifier quantifier, std::string condition) { return {quantifier, std::move(condition)}; }
FormulaText spanned(FormulaText text, std::optional<double> from, std::optional<double> until) {
  text.from = from;
  text.until = until;
  return text;
}
FormulaText after(FormulaText text, std::string condition, std::optional<double> within = {},
                  std::optional<double> lasting = {}) {
  text.after = std::move(condition);
  text.within = within;
  text.lasting = lasting;
  return text;
}
FormulaText except(FormulaText text, std::string condition, std::optional<double> lasting = {}) {
  text.except = std::move(condition);
  text.lasting = lasting;
  return text;
}
FormulaText lasting(FormulaText text, double time) {
  text.lasting = time;
  return text;
}
FormulaText within(FormulaText text, double time) {
  text.within = time;
  return text;
}

INSTANTIATE_TEST_SUITE_P(
    Comparisons, FormulaTable,
    ::testing::Values(Row{of(always, "a < 6"), holds, 1, 0.4}, Row{of(always, "a < 5"), violated, 0, 0.4, false, 0.4},
                      Row{of(always, "a <= 5"), holds, 0, 0.4}, Row{of(always, "a > -1"), holds, 1, 0.9},
                      Row{of(always, "a >= 0"), holds, 0, 0.9}, Row{of(always, "a > 0"), violated, 0, 0.9},
                      Row{of(always, "a == 2"), violated, -3, 0.4, false, 0.0},
                      Row{of(always, "a != 9"), holds, 4, 0.4}, Row{of(always, "a != 2"), violated, 0, 0.1},
                      Row{of(always, "6 > a"), holds, 1, 0.4}, Row{of(always, "a < 6 m"), holds, 1, 0.4},
                      Row{of(always, "a < 600 cm"), holds, 1, 0.4}, Row{of(always, "a - b < 4"), violated, 0, 0.5},
                      Row{of(always, "abs(c) <= 1"), holds, 0, 0.0}, Row{of(always, "max(a, b) < 7"), holds, 2, 0.3},
                      Row{of(always, "min(a, b) < 7"), holds, 2, 0.4}, Row{of(always, "2 * a + 1 < 12"), holds, 1, 0.4},
                      Row{of(always, "a / 2 < 3"), holds, 0.5, 0.4}, Row{of(always, "-a > -6"), holds, 1, 0.4},
                      Row{of(always, "a < b + 5"), holds, 1}, Row{of(always, "time < 1"), holds, 0.1, 0.9},
                      Row{of(always, "abs(delta(a)) < 2 || tick == 0"), holds, 0}));

INSTANTIATE_TEST_SUITE_P(
    Conditions, FormulaTable,
    ::testing::Values(
        Row{of(always, "a < 6 && a > -2"), holds, 1, 0.4}, Row{of(always, "a < 9 && a > -1"), holds, 1, 0.9},
        Row{of(always, "a < 3 || a > 1"), holds, 1}, Row{of(always, "a < 2 || a > 3"), violated, 0, 0.1, false, 0.1},
        Row{of(always, "!(a > 6)"), holds, 1, 0.4}, Row{of(always, "!(a >= 5)"), violated, 0, 0.4},
        Row{of(always, "contact(FOOT)"), violated, none, -1, false, 0.0},
        Row{of(always, "contact(FOOT) || a < 6"), holds, 1, 0.4},
        Row{of(always, "contact(FOOT) && a < 6"), violated, none, -1, false, 0.0}, Row{of(always, "true"), holds, none},
        Row{of(eventually, "false"), violated, none}, Row{of(always, "!contact(FOOT) || a > 2"), holds, 1, 0.2},
        Row{of(always, "(a > 2) == (a > 2)"), holds, none}, Row{of(always, "prev(a) < 6 || tick == 0"), holds, 0},
        Row{of(always, "changed(a)"), violated, none, -1, false, 0.0}));

INSTANTIATE_TEST_SUITE_P(
    Quantifiers, FormulaTable,
    ::testing::Values(Row{of(eventually, "a > 4"), holds, 1, 0.4}, Row{of(eventually, "a >= 5"), holds, 0, 0.4},
                      Row{of(eventually, "a > 5"), violated, 0, 0.4, false, 0.4},
                      Row{of(eventually, "a > 7"), violated, -2, 0.4}, Row{of(never, "a > 6"), holds, 1, 0.4},
                      Row{of(never, "a > 4"), violated, -1, 0.4, false, 0.4}, Row{of(never, "a == 9"), holds, 4, 0.4},
                      Row{of(eventually, "contact(FOOT)"), holds, none},
                      Row{of(never, "contact(FOOT)"), violated, none}, Row{of(never, "a > 3 && b > 6"), holds, 1}));

INSTANTIATE_TEST_SUITE_P(Spans, FormulaTable,
                         ::testing::Values(Row{spanned(of(always, "a < 5"), 0.5, {}), holds, 1, 0.5},
                                           Row{spanned(of(always, "a < 5"), {}, 0.3), holds, 1, 0.3},
                                           Row{spanned(of(always, "a < 5"), {}, 0.4), violated, 0, 0.4},
                                           Row{spanned(of(always, "a < 5"), 0.4, 0.4), violated, 0, 0.4},
                                           Row{spanned(of(eventually, "a > 4"), 0.5, {}), violated, 0, 0.5},
                                           Row{spanned(of(always, "a < 6"), {}, 2.0), undecided, none},
                                           Row{spanned(of(always, "a < 5"), {}, 2.0), violated, 0, 0.4},
                                           Row{spanned(of(eventually, "a > 4"), {}, 2.0), holds, 1, 0.4},
                                           Row{spanned(of(eventually, "a > 7"), {}, 2.0), undecided, none},
                                           Row{spanned(of(always, "a < 6"), {}, 0.9), holds, 1, 0.4}));

INSTANTIATE_TEST_SUITE_P(
    Windows, FormulaTable,
    ::testing::Values(
        // a > 2 in ticks 2 to 6
        Row{lasting(of(eventually, "a > 2"), 0.4), holds, 1}, Row{lasting(of(eventually, "a > 2"), 0.5), violated, 0},
        Row{lasting(of(never, "a > 2"), 0.5), holds, 0}, Row{lasting(of(never, "a > 2"), 0.4), violated, -1},
        Row{of(never, "a > 2 for 0.5 s"), holds, 0}, Row{of(never, "a > 2 for 400 ms"), violated, -1},
        Row{of(always, "!(a > 2 for 0.5 s)"), holds, 0}, Row{of(eventually, "(a > 2 && b > 1) for 0.1 s"), holds, 2},
        // in the last tick a < 1, and the run ends: it may last
        Row{of(never, "a < 1 for 0.2 s"), undecided, none}, Row{of(eventually, "a < 1 for 0.2 s"), undecided, none},
        Row{of(eventually, "a < 2 for 0.1 s"), holds, 1, 0.8}, Row{of(never, "a < -1 for 0.2 s"), holds, 1, 0.9},
        Row{of(always, "a < 6 for 0.2 s"), undecided, none},
        Row{of(always, "a < 5 for 0.2 s"), violated, 0, 0.4, false, 0.2},
        Row{of(always, "a < 6 for 0 s"), holds, 1, 0.4},
        Row{spanned(of(always, "a < 6 for 0.2 s"), {}, 0.7), holds, 1, 0.4},
        // c > 0 in every second tick
        Row{within(of(always, "c > 0"), 0.1), holds, 1}, Row{within(of(always, "c > 0"), 0.0), violated, -1},
        Row{within(of(always, "c < 0"), 0.1), undecided, none},
        Row{spanned(within(of(always, "c < 0"), 0.1), {}, 0.8), holds, 1},
        Row{within(of(always, "a > 3"), 0.3), violated, 0, 0.6, false, 0.6}));

INSTANTIATE_TEST_SUITE_P(After, FormulaTable,
                         ::testing::Values(
                             // the foot comes down in ticks 2 and 6
                             Row{after(of(always, "a > 3"), "contact(FOOT)", 0.1), violated, 0, 0.6, false, 0.6},
                             Row{spanned(after(of(always, "a > 3"), "contact(FOOT)", 0.1), {}, 0.5), holds, 1, 0.3},
                             Row{after(of(always, "a < 4"), "contact(FOOT)", 0.0), holds, 1},
                             Row{after(of(always, "b > 1"), "a >= 3", 0.1), holds, 4, 0.3},
                             Row{after(of(always, "a > 9"), "a > 8", 0.1), holds, none},
                             Row{after(of(always, "a > 9"), "false"), holds, none},
                             Row{after(of(always, "a > -1"), "contact(FOOT)"), holds, 1, 0.9},
                             Row{after(of(always, "a < 5"), "a > 4"), violated, 0, 0.4, false, 0.4},
                             Row{after(of(always, "a < 5"), "b < 0 || tick == 5"), holds, 1, 0.5},
                             Row{after(of(always, "a > 2"), "contact(FOOT)", {}, 0.1), violated, 0, 0.7, false, 0.6},
                             Row{after(of(always, "a > 1"), "contact(FOOT)", {}, 0.1), holds, 1, 0.7},
                             Row{after(of(always, "b > 1"), "contact(FOOT)", 0.1, 0.1), violated, -1, -1, false, 0.6},
                             Row{after(of(always, "a > -1"), "a < 1", {}, 0.1), undecided, none},
                             Row{after(of(always, "a > 1"), "a < 1", 0.1), undecided, none},
                             Row{after(of(eventually, "a > 4"), "contact(FOOT)"), violated, -1, 0.6, false, 0.6},
                             Row{after(of(eventually, "a < 1"), "contact(FOOT)"), holds, 1, 0.9},
                             Row{after(of(eventually, "a > 4"), "tick == 0"), holds, 1, 0.4},
                             Row{after(of(eventually, "a > 4"), "contact(FOOT)", 0.2), violated, -1, 0.6, false, 0.6},
                             Row{after(of(never, "b > 1"), "a > 4"), violated, -4, 0.4, false, 0.4},
                             Row{after(of(never, "b > 1"), "tick == 5"), holds, 1, 0.5},
                             Row{after(of(never, "a > 4"), "contact(FOOT)", 0.1), holds, 0, 0.3},
                             Row{after(of(never, "a > 4"), "contact(FOOT)", 0.2), violated, -1, 0.4, false, 0.2},
                             Row{after(of(always, "a < 9"), "true"), holds, 4, 0.4}));

INSTANTIATE_TEST_SUITE_P(Except, FormulaTable,
                         ::testing::Values(
                             // a > 3 in ticks 3 to 5, after b has jumped in tick 3
                             Row{except(of(always, "a < 4"), "step(b)", 0.2), holds, 1},
                             Row{except(of(always, "a < 4"), "step(b)", 0.1), holds, 1},
                             Row{except(of(always, "a < 4"), "b > 1"), violated, 0, 0.5, false, 0.5},
                             Row{except(of(always, "a < 4"), "b > 1", 0.1), holds, 1},
                             Row{except(of(never, "a > 3"), "b > 1", 0.1), holds, 0},
                             Row{except(of(eventually, "a > 4"), "b > 1"), violated, 0, 0.5},
                             Row{except(of(eventually, "a >= 4"), "b > 1"), holds, 0, 0.5},
                             Row{except(of(always, "a < 0"), "true"), holds, none},
                             Row{except(of(always, "a < 6"), "false"), holds, 1, 0.4}));

INSTANTIATE_TEST_SUITE_P(
    NotANumber, FormulaTable,
    ::testing::Values(
        Row{of(always, "n < 2"), violated, none, -1, true, 0.3}, Row{of(never, "n > 2"), violated, none, -1, true, 0.3},
        Row{of(always, "n < 1"), violated, 0, 0.0, false, 0.0}, Row{of(eventually, "n > 0"), holds, 1, 0.0},
        Row{of(eventually, "n > 2"), violated, none, -1, true, 0.3}, Row{of(always, "nan(n) || n < 2"), holds, 1, 0.0},
        Row{of(always, "n != 2"), violated, none, -1, true, 0.3}, Row{of(always, "n < 2 || a > 3"), holds, 1},
        Row{except(of(always, "n < 2"), "tick == 3"), holds, 1}, Row{of(eventually, "n > 2 for 0.1 s"), violated, -1},
        Row{spanned(of(always, "prev(n) < 2"), {}, 0.0), violated, none, -1, true, 0.0}));

TEST(Formula, WithoutATickInItsSpanIsNotJudged) {
  SampledSource source = ten_ticks();
  EXPECT_FALSE(testing::judged(spanned(of(always, "a < 6"), 0.31, 0.39), source).any_tick);
  source.times.clear();
  EXPECT_FALSE(testing::judged(of(always, "a < 6"), source).any_tick);
}

TEST(Formula, KnowsWhetherItsConditionBecameTrue) {
  SampledSource source = ten_ticks();
  EXPECT_TRUE(testing::judged(after(of(always, "a < 9"), "contact(FOOT)"), source).triggered);
  EXPECT_FALSE(testing::judged(after(of(always, "a < 9"), "a > 8"), source).triggered);
}

}  // namespace
}  // namespace rehearse
