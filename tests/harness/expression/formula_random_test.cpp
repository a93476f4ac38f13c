// A thousand random formulas on random runs: the judge's truth and margin are those of an evaluator from the
// definitions of signal temporal logic, which shares no code with it and looks at all pairs of ticks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>

#include "sampled_source.h"

namespace rehearse {
namespace {

using testing::FormulaText;
using testing::SampledSource;

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Truth and margin, at worst and at best for the data that are missing, and why they are missing.
struct Value {
  bool worst_truth = false, best_truth = false;
  double worst = 0.0, best = 0.0;
  bool is_nan = false, is_cut = false, is_early = false;  // early: before a first sample

  bool is_unknown() const { return worst_truth != best_truth; }
  bool is_before_span() const { return is_unknown() && is_early && !is_nan && !is_cut; }
};
using Values = std::vector<Value>;  // by tick

Value of_truth(bool truth) {
  const double margin = truth ? infinite : -infinite;
  return {truth, truth, margin, margin};
}
const Value nan_value{false, true, -infinite, infinite, true};
const Value cut_value{false, true, -infinite, infinite, false, true};
const Value early_value{false, true, -infinite, infinite, false, false, true};

Value negation(const Value& v) {
  return {!v.best_truth, !v.worst_truth, -v.best, -v.worst, v.is_nan, v.is_cut, v.is_early};
}
Value least(const Value& a, const Value& b) {
  Value value{a.worst_truth && b.worst_truth, a.best_truth && b.best_truth, std::min(a.worst, b.worst),
              std::min(a.best, b.best)};
  if (!value.is_unknown()) return value;
  value.is_nan = (a.is_unknown() && a.is_nan) || (b.is_unknown() && b.is_nan);
  value.is_cut = (a.is_unknown() && a.is_cut) || (b.is_unknown() && b.is_cut);
  value.is_early = (a.is_unknown() && a.is_early) || (b.is_unknown() && b.is_early);
  return value;
}
Value most(const Value& a, const Value& b) { return negation(least(negation(a), negation(b))); }

/// The ticks of a run. A window of ticks is longer by a nanosecond, as times are rounded.
struct SampledRun {
  SampledSource source;
  std::size_t size() const { return source.times.size(); }
  std::uint64_t time(std::size_t tick) const { return source.times[tick]; }
  bool has_sample(const std::string& name, std::size_t tick) const {
    const auto first = source.first_sample.find(name);
    return first == source.first_sample.end() || static_cast<std::int64_t>(tick) >= first->second;
  }
  bool follows_within(std::size_t earlier, std::size_t later, std::uint64_t window) const {
    return later >= earlier && time(later) - time(earlier) <= window + 1;
  }
  /// When a tick would follow the last one.
  std::uint64_t next_time() const {
    std::uint64_t step = size() < 2 ? 0 : time(1) - time(0);
    for (std::size_t i = 1; i < size(); ++i) step = std::min(step, time(i) - time(i - 1));
    return source.times.back() + std::max<std::uint64_t>(step, 3);
  }
  bool ends_before(std::uint64_t end) const { return end + 1 >= next_time(); }
  bool cuts(std::size_t tick, std::uint64_t window) const { return ends_before(time(tick) + window); }
};

Values map(const Values& of, Value (*function)(const Value&)) {
  Values values;
  for (const Value& value : of) values.push_back(function(value));
  return values;
}
Values combine(const Values& a, const Values& b, Value (*function)(const Value&, const Value&)) {
  Values values;
  for (std::size_t i = 0; i < a.size(); ++i) values.push_back(function(a[i], b[i]));
  return values;
}
Values guard(const Values& of) {
  return map(of, [](const Value& v) {
    return Value{v.worst_truth,
                 v.best_truth,
                 v.worst_truth ? infinite : -infinite,
                 v.best_truth ? infinite : -infinite,
                 v.is_nan,
                 v.is_cut,
                 v.is_early};
  });
}
Values all_in_window(const SampledRun& run, const Values& of, std::uint64_t window) {
  Values values;
  for (std::size_t i = 0; i < run.size(); ++i) {
    Value value = run.cuts(i, window) ? cut_value : of_truth(true);
    for (std::size_t j = 0; j < run.size(); ++j)
      if (run.follows_within(i, j, window)) value = least(value, of[j]);
    values.push_back(value);
  }
  return values;
}
Values some_in_window(const SampledRun& run, const Values& of, std::uint64_t window) {
  return map(all_in_window(run, map(of, negation), window), negation);
}
Values some_before(const SampledRun& run, const Values& of, std::uint64_t window) {
  Values values;
  for (std::size_t i = 0; i < run.size(); ++i) {
    Value value = of_truth(false);
    for (std::size_t j = 0; j <= i; ++j)
      if (run.follows_within(j, i, window) && (i == j || !of[j].is_before_span())) value = most(value, of[j]);
    values.push_back(value);
  }
  return values;
}
Values rises(const Values& of) {
  const Values truths = guard(of);
  Values values;
  for (std::size_t i = 0; i < truths.size(); ++i)
    values.push_back(
        least(truths[i], i == 0 || truths[i - 1].is_before_span() ? of_truth(true) : negation(truths[i - 1])));
  return values;
}

/// A random condition: its text, and its values.
struct Condition {
  std::string text;
  Values values;
};

class Generator {
 public:
  explicit Generator(unsigned seed) : random_(seed) {}

  int number(int low, int high) { return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1)); }
  bool chance(int percent) { return number(1, 100) <= percent; }
  double duration() { return 0.005 * number(0, 12); }

  SampledRun run() {
    SampledRun made;
    const int ticks = number(1, 40);
    std::uint64_t time = 0;
    const bool is_even = chance(50), has_nan = chance(30);
    for (int i = 0; i < ticks; ++i, time += is_even ? 10'000'000 : 5'000'000 * static_cast<unsigned>(number(1, 4))) {
      made.source.times.push_back(time);
      for (const char* name : {"a", "b"})
        made.source.series[name].push_back(has_nan && chance(5) ? std::nan("") : 0.5 * number(-6, 6));
      made.source.foot.push_back(chance(30));
    }
    for (const char* name : {"a", "b"}) {
      if (!chance(20)) continue;
      const int first = number(1, ticks);
      made.source.first_sample[name] = first;
      std::fill_n(made.source.series[name].begin(), first, std::nan(""));
    }
    return made;
  }

  /// Of numbers of a tick.
  Condition atom(const SampledRun& run) {
    if (chance(15)) {
      Condition contact{"contact(FOOT)", {}};
      for (std::size_t i = 0; i < run.size(); ++i) contact.values.push_back(of_truth(run.source.foot[i]));
      return contact;
    }
    const std::vector<double>&a = run.source.series.at("a"), &b = run.source.series.at("b");
    const double bound = 0.5 * number(-5, 5);
    const int form = number(0, 4);
    const char* symbol = std::array{"<", "<=", ">", ">=", "==", "!="}[static_cast<std::size_t>(number(0, 5))];
    const std::string left =
        std::array<std::string, 5>{"a", "a", "abs(a)", "max(a, b)", "prev(a)"}[static_cast<std::size_t>(form)];
    const std::string right = form == 1 ? "b" : fmt::format("{}", bound);
    Condition made{fmt::format("{} {} {}", left, symbol, right), {}};
    for (std::size_t i = 0; i < run.size(); ++i) {
      const double before = i == 0 ? std::nan("") : a[i - 1];
      const double largest = std::isnan(a[i]) || std::isnan(b[i]) ? std::nan("") : std::max(a[i], b[i]);
      const double x = std::array{a[i], a[i], std::abs(a[i]), largest, before}[static_cast<std::size_t>(form)];
      const bool needs_b = form == 1 || form == 3, needs_before = form == 4;
      const bool is_early = (needs_before && (i == 0 || !run.has_sample("a", i - 1))) || !run.has_sample("a", i) ||
                            (needs_b && !run.has_sample("b", i));
      made.values.push_back(is_early ? early_value : compared(x, symbol, form == 1 ? b[i] : bound));
    }
    return made;
  }

  Condition condition(const SampledRun& run, int depth, bool may_last) {
    const int form = depth == 0 ? 0 : number(0, may_last ? 5 : 3);
    if (form == 0) return atom(run);
    Condition left = condition(run, depth - 1, may_last);
    if (form == 1) return {fmt::format("!({})", left.text), map(left.values, negation)};
    if (form >= 4) {
      const double time = duration();
      return {fmt::format("({}) for {} s", left.text, time), all_in_window(run, left.values, testing::in_ns(time))};
    }
    const Condition right = condition(run, depth - 1, may_last);
    return {fmt::format("(({}) {} ({}))", left.text, form == 2 ? "&&" : "||", right.text),
            combine(left.values, right.values, form == 2 ? least : most)};
  }

 private:
  static Value compared(double x, std::string_view symbol, double y) {
    if (std::isnan(x) || std::isnan(y)) return nan_value;
    bool truth = false;
    double margin = 0.0;
    if (symbol == "<") truth = x < y, margin = y - x;
    if (symbol == "<=") truth = x <= y, margin = y - x;
    if (symbol == ">") truth = x > y, margin = x - y;
    if (symbol == ">=") truth = x >= y, margin = x - y;
    if (symbol == "==") truth = x == y, margin = -std::abs(x - y);
    if (symbol == "!=") truth = x != y, margin = std::abs(x - y);
    return {truth, truth, margin, margin};
  }

  std::mt19937 random_;
};

/// The whole formula, from the definitions on the page concepts/expectations.md.
Value whole(const SampledRun& run, const FormulaText& f, const Values& condition, const Values& after,
            const Values& except, bool& is_judged) {
  Values core = condition;
  const std::uint64_t lasting = testing::in_ns(f.lasting.value_or(0.0)),
                      within = testing::in_ns(f.within.value_or(0.0));
  const bool is_never = f.quantifier == Quantifier::never, is_some = f.quantifier == Quantifier::eventually;
  if (f.lasting && except.empty()) core = all_in_window(run, core, lasting);
  if (is_never) core = map(core, negation);
  if (!except.empty()) {
    const Values excepted = some_before(run, guard(except), lasting);
    core = is_some ? combine(core, map(excepted, negation), least) : combine(core, excepted, most);
  }
  if (f.within) core = is_never ? all_in_window(run, core, within) : some_in_window(run, core, within);
  const auto in_span = [&](std::size_t tick) {
    return run.time(tick) >= testing::in_ns(f.from.value_or(0.0)) &&
           (!f.until || run.time(tick) <= testing::in_ns(*f.until));
  };
  const bool is_over = !f.until || !run.ends_before(testing::in_ns(*f.until));
  const bool is_of_one = is_some && after.empty();
  Value result = of_truth(!is_of_one);
  const auto judge = [&](const Value& here) {
    if (here.is_before_span()) return;
    is_judged = is_judged || !here.is_unknown() || here.is_nan || !here.is_early;
    result = is_of_one ? most(result, here) : least(result, here);
  };
  const Values rise = after.empty() ? Values() : rises(after);
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (!in_span(i)) continue;
    Value here = core[i];
    if (!after.empty() && is_some && !f.within) {
      if (rise[i].is_before_span()) continue;
      here = of_truth(false);
      bool any = false;
      for (std::size_t j = i; j < run.size(); ++j) {
        if (!in_span(j) || core[j].is_before_span() || rise[j].is_before_span()) continue;
        here = most(here, core[j]);
        any = true;
      }
      if (!any && rise[i].best_truth) here = early_value;
      if (!is_over) here = most(here, cut_value);
      here = most(here, negation(rise[i]));
    } else if (!after.empty() && (f.within || (f.lasting && except.empty() && !is_never))) {
      here = most(here, negation(rise[i]));
    } else if (!after.empty()) {
      Value once = rise[i];
      for (std::size_t j = 0; j < i; ++j)
        if (in_span(j) && !rise[j].is_before_span()) once = most(once, rise[j]);
      here = most(here, negation(once));
    }
    judge(here);
  }
  if (is_over) return result;
  return is_of_one ? most(result, cut_value) : least(result, cut_value);
}

TEST(RandomFormulas, HaveTheTruthAndMarginOfTheDefinitions) {
  std::array<int, 3> states{};
  int finite = 0, not_judged = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Generator generator(seed);
    SampledRun run = generator.run();
    FormulaText f;
    f.quantifier = static_cast<Quantifier>(generator.number(0, 2));
    const Condition condition = generator.condition(run, 3, true);
    Condition after, except;
    f.condition = condition.text;
    if (generator.chance(50)) after = generator.condition(run, 1, true);
    if (generator.chance(30)) except = generator.condition(run, 1, generator.chance(30));
    f.after = after.text;
    f.except = except.text;
    const bool is_always = f.quantifier == Quantifier::always;
    if (generator.chance(40) && (is_always || !f.after.empty())) f.within = generator.duration();
    if (generator.chance(40)) f.lasting = generator.duration();
    if (generator.chance(30)) f.from = 0.01 * generator.number(0, 10);
    if (generator.chance(30)) f.until = f.from.value_or(0.0) + 0.01 * generator.number(0, 40);

    bool is_judged = false;
    const Value expected = whole(run, f, condition.values, after.values, except.values, is_judged);
    const FormulaResult result = testing::judged(f, run.source);
    const std::string told =
        fmt::format("seed {}: {} '{}' after '{}' except '{}' within {} for {} from {} until {}", seed,
                    static_cast<int>(f.quantifier), f.condition, f.after, f.except, f.within.value_or(-1),
                    f.lasting.value_or(-1), f.from.value_or(-1), f.until.value_or(-1));
    const bool any_tick = std::ranges::any_of(run.source.times, [&](std::uint64_t time) {
      return time >= testing::in_ns(f.from.value_or(0.0)) && (!f.until || time <= testing::in_ns(*f.until));
    });
    ASSERT_EQ(result.any_tick, any_tick) << told;
    if (!any_tick) continue;
    const bool is_eventually_after = f.quantifier == Quantifier::eventually && !f.after.empty() && !f.within;
    if (!is_judged && !is_eventually_after) {
      ++not_judged;
      ASSERT_TRUE(!result.is_judged && result.state == FormulaResult::State::undecided) << told;
      continue;
    }
    if (is_eventually_after && !result.is_judged) continue;  // by hand in formula_table_test.cpp
    const bool is_violated = result.state == FormulaResult::State::violated && !result.is_nan;
    ASSERT_EQ(result.state == FormulaResult::State::holds, expected.worst_truth) << told;
    ASSERT_EQ(is_violated, !expected.best_truth) << told;
    ++states[static_cast<std::size_t>(result.state)];
    const double margin = expected.worst_truth ? expected.worst : expected.best;
    const bool has_margin = (expected.worst_truth || !expected.best_truth) && std::isfinite(margin);
    ASSERT_EQ(result.decisive.has_value(), has_margin) << told;
    if (!has_margin) continue;
    ASSERT_EQ(result.decisive->judgement.margin, margin) << told;
    ++finite;
  }
  for (const int count : states) EXPECT_GT(count, 100) << "each state is tested";
  EXPECT_GT(finite, 300);
  EXPECT_GT(not_judged, 10);
}

}  // namespace
}  // namespace rehearse
