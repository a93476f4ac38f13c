// Formulas on one run of ten ticks, with their truth and margin by hand: every operator, and every edge.
//
// tick    0    1    2    3    4    5    6    7    8    9
// time    0.0  0.1  0.2  0.3  0.4  0.5  0.6  0.7  0.8  0.9 s
// a       1    2    3    4    5    4    3    2    1    0   m
// b       0    0    0    5    5    0    0    0    0    0   m
// c       -1   1    -1   1    -1   1    -1   1    -1   1   m
// n       1    1    1    NaN  1    1    1    1    1    1   m
// late    .    .    .    4    5    4    3    2    1    0   m, no sample before tick 3
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
  source.series["late"] = {none, none, none, 4, 5, 4, 3, 2, 1, 0};
  source.first_sample["late"] = 3;
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
        Row{of(always, "changed(b)"), violated, none, -1, false, 0.1}));

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

INSTANTIATE_TEST_SUITE_P(NotANumber, FormulaTable,
                         ::testing::Values(Row{of(always, "n < 2"), violated, none, -1, true, 0.3},
                                           Row{of(never, "n > 2"), violated, none, -1, true, 0.3},
                                           Row{of(always, "n < 1"), violated, 0, 0.0, false, 0.0},
                                           Row{of(eventually, "n > 0"), holds, 1, 0.0},
                                           Row{of(eventually, "n > 2"), violated, none, -1, true, 0.3},
                                           Row{of(always, "nan(n) || n < 2"), holds, 1, 0.0},
                                           Row{of(always, "n != 2"), violated, none, -1, true, 0.3},
                                           Row{of(always, "n < 2 || a > 3"), holds, 1},
                                           Row{except(of(always, "n < 2"), "tick == 3"), holds, 1},
                                           Row{of(eventually, "n > 2 for 0.1 s"), violated, -1},
                                           Row{of(always, "n < 2 for 0.3 s"), violated, none, -1, true, 0.0},
                                           Row{of(always, "prev(n) < 2"), violated, none, -1, true, 0.4}));

// A span begins with the first samples: of a series, and of the tick before.
INSTANTIATE_TEST_SUITE_P(
    FirstSamples, FormulaTable,
    ::testing::Values(
        Row{of(always, "late < 6"), holds, 1, 0.4}, Row{of(always, "late < 5"), violated, 0, 0.4, false, 0.4},
        Row{of(never, "late > 6"), holds, 1, 0.4}, Row{of(eventually, "late > 4"), holds, 1, 0.4},
        Row{of(eventually, "late > 7"), violated, -2, 0.4}, Row{of(always, "late != 9"), holds, 4, 0.4},
        Row{of(always, "abs(-late) + a < 11"), holds, 1, 0.4}, Row{of(always, "min(late, a) >= 0"), holds, 0},
        Row{of(never, "nan(late)"), holds, none}, Row{of(always, "nan(late)"), violated, none, -1, false, 0.3},
        // the other series decide
        Row{of(always, "late < 6 && a < 6"), holds, 1, 0.4},
        Row{of(always, "late < 6 && a > 1"), violated, -1, 0.9, false, 0.0},
        Row{of(always, "late < 0 || a < 6"), holds, 1, 0.4}, Row{of(eventually, "late > 9 || a > 4"), holds, 1},
        // the tick before
        Row{of(always, "prev(a) < 6"), holds, 1, 0.5}, Row{of(always, "prev(prev(a)) < 6"), holds, 1, 0.6},
        Row{of(always, "abs(delta(a)) < 2"), holds, 1, 0.1}, Row{of(always, "abs(delta(late)) < 2"), holds, 1, 0.4},
        Row{of(always, "changed(a)"), holds, none}, Row{of(always, "changed(late)"), holds, none},
        Row{of(always, "prev(tick < 9)"), holds, 1, 0.9}, Row{of(never, "step(late, 1.5 m)"), holds, none},
        Row{of(never, "step(a)"), violated, none, -1, false, 0.1},
        Row{of(always, "changed(late > 9) == false"), holds, none},
        // a moment
        Row{of(always, "late <= at(late, 0.3 s) + 1"), holds, 0, 0.4}, Row{of(always, "a <= at(a, 0.4 s)"), holds, 0},
        // windows
        Row{spanned(of(always, "late < 6 for 0.2 s"), {}, 0.7), holds, 1, 0.4},
        Row{of(never, "late > 3 for 0.2 s"), violated, -1, -1, false, 0.3},
        Row{spanned(within(of(always, "late > 1"), 0.1), {}, 0.6), holds, 2, 0.6},
        // triggers: a condition that is true with its first sample becomes true there
        Row{after(of(always, "a < 5"), "late > 3"), violated, 0, 0.4, false, 0.4},
        Row{after(of(always, "late < 5"), "tick == 0"), violated, 0, 0.4, false, 0.4},
        Row{after(of(always, "a > 9"), "late > 5"), holds, none},
        Row{after(of(always, "a > 4"), "late > 3", 0.1), holds, 1, 0.4},
        Row{after(of(eventually, "late > 4"), "tick == 1"), holds, 1, 0.4},
        Row{after(of(eventually, "a > 4"), "late > 3"), holds, 1, 0.4},
        // exceptions: nothing is excepted because of what came before a span
        Row{except(of(always, "a < 4"), "late > 9", 0.5), violated, -1, 0.4, false, 0.3},
        Row{except(of(always, "a < 3"), "late >= 3", 0.1), holds, 1}));

// A time between two ticks isn't missing, if it is before the tick that would be the next.
INSTANTIATE_TEST_SUITE_P(Ends, FormulaTable,
                         ::testing::Values(Row{spanned(of(always, "a < 6"), {}, 0.95), holds, 1, 0.4},
                                           Row{spanned(of(always, "a < 6"), {}, 1.0), undecided, none},
                                           Row{of(always, "a < 6 for 0.05 s"), holds, 1, 0.4},
                                           Row{of(always, "a < 6 for 0.1 s"), undecided, none},
                                           Row{within(of(always, "a < 6"), 0.05), holds, 1, 0.4},
                                           Row{after(of(eventually, "a > 4"), "tick == 9", 0.05), violated, -4, 0.9},
                                           Row{after(of(eventually, "a > 4"), "tick == 9", 0.1), undecided, none}));

// A condition that becomes true before the span demands nothing.
INSTANTIATE_TEST_SUITE_P(
    TriggersOutOfTheSpan, FormulaTable,
    ::testing::Values(Row{spanned(after(of(always, "a > 9"), "a > 4"), 0.5, {}), holds, none},
                      Row{spanned(after(of(always, "a > 9"), "a > 4"), 0.4, {}), violated, -9, 0.9, false, 0.4},
                      Row{spanned(after(of(never, "a < 2"), "contact(FOOT)"), 0.7, {}), holds, none},
                      Row{spanned(after(of(eventually, "a > 9"), "contact(FOOT)"), 0.7, {}), holds, none},
                      Row{spanned(after(of(always, "a > 9"), "contact(FOOT)", 0.1), 0.7, {}), holds, none},
                      Row{spanned(after(of(always, "a > 9"), "contact(FOOT)", {}, 0.1), 0.7, {}), holds, none}));

TEST(Formula, WithoutATickInItsSpanIsNotJudged) {
  SampledSource source = ten_ticks();
  EXPECT_FALSE(testing::judged(spanned(of(always, "a < 6"), 0.31, 0.39), source).any_tick);
  source.times.clear();
  EXPECT_FALSE(testing::judged(of(always, "a < 6"), source).any_tick);
}

TEST(Formula, WithoutASampleInItsSpanIsNotJudged) {
  SampledSource source = ten_ticks();
  for (const FormulaText& text :
       {spanned(of(always, "late < 6"), {}, 0.2), spanned(of(never, "late < 6"), {}, 0.2),
        spanned(of(eventually, "late < 6"), {}, 0.2), spanned(of(always, "prev(a) < 6"), {}, 0.0),
        spanned(of(always, "late < 6 for 0.1 s"), {}, 0.2), spanned(within(of(always, "late < 0"), 0.1), {}, 0.2),
        spanned(after(of(always, "late < 0"), "tick == 0"), 0.0, 0.2),
        spanned(after(of(eventually, "late < 0"), "tick == 0"), 0.0, 0.2),
        spanned(after(of(eventually, "a > 9"), "late < 0"), 0.0, 0.2),
        spanned(except(of(always, "a > 9"), "late < 0"), 0.0, 0.2)}) {
    const FormulaResult result = testing::judged(text, source);
    EXPECT_EQ(result.state, undecided) << Row{text, undecided, none};
    EXPECT_TRUE(result.any_tick && !result.is_judged && !result.first) << Row{text, undecided, none};
  }
  const FormulaResult vacuous = testing::judged(after(of(eventually, "late < 6"), "a > 9"), source);
  EXPECT_EQ(vacuous.state, holds);
}

TEST(Formula, KnowsWhetherItsConditionBecameTrue) {
  SampledSource source = ten_ticks();
  EXPECT_TRUE(testing::judged(after(of(always, "a < 9"), "contact(FOOT)"), source).triggered);
  EXPECT_FALSE(testing::judged(after(of(always, "a < 9"), "a > 8"), source).triggered);
}

}  // namespace
}  // namespace rehearse
