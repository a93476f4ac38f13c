// Series by hand, with the times of their ticks, for tests of formulas.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/expression/expression.h"
#include "core/expression/formula.h"

namespace rehearse::testing {

/// The values of some series at each tick, and the ticks at which the foot touches the floor.
class SampledSource final : public ExpressionSource {
 public:
  std::vector<std::uint64_t> times;  // of the ticks [ns]
  std::map<std::string, std::vector<double>> series;
  std::map<std::string, std::int64_t> first_sample;  // ticks; without one the first tick has a sample
  std::vector<bool> foot;

  Result<std::size_t> find_series(std::string_view name) override {
    std::size_t index = 0;
    for (const auto& [known, values] : series) {
      if (known == name) return index;
      ++index;
    }
    return error("there is no series '" + std::string(name) + "'");
  }
  std::string unit_of_series(std::size_t) override { return "m"; }
  Result<std::vector<std::size_t>> find_links(std::string_view) override { return std::vector<std::size_t>{0}; }
  std::int64_t last_tick() const override { return static_cast<std::int64_t>(times.size()) - 1; }
  double time_at(std::int64_t tick) const override {
    return static_cast<double>(times[static_cast<std::size_t>(tick)]) * 1e-9;
  }
  double value(std::size_t index, std::int64_t tick, CommandSide) override {
    return std::next(series.begin(), static_cast<std::ptrdiff_t>(index))->second[static_cast<std::size_t>(tick)];
  }
  Sampled sampled(std::size_t index, std::int64_t tick, CommandSide) const override {
    const auto first = first_sample.find(std::next(series.begin(), static_cast<std::ptrdiff_t>(index))->first);
    return first == first_sample.end() || first->second <= tick ? Sampled::yes : Sampled::no;
  }
  Sampled sampled_at(std::size_t index, double time, std::int64_t tick) const override {
    return tick_at(time) <= tick ? sampled(index, tick_at(time), CommandSide::recorded) : Sampled::no;
  }
  double value_at(std::size_t index, double time, std::int64_t tick) override {
    return tick_at(time) <= tick ? value(index, tick_at(time), CommandSide::recorded)
                                 : std::numeric_limits<double>::quiet_NaN();
  }
  bool touching(const std::vector<std::size_t>&, const std::vector<std::size_t>&, std::int64_t tick) override {
    return foot[static_cast<std::size_t>(tick)];
  }

 private:
  /// The latest tick up to a time [s].
  std::int64_t tick_at(double time) const {
    std::int64_t tick = 0;
    while (tick < last_tick() && time_at(tick + 1) <= time + 1e-9) ++tick;
    return tick;
  }
};

/// A formula as texts; times in seconds, empty texts: none.
struct FormulaText {
  Quantifier quantifier = Quantifier::always;
  std::string condition, after = {}, except = {};
  std::optional<double> within = {}, lasting = {}, from = {}, until = {};
};

inline std::uint64_t in_ns(double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); }

/// The expressions must be right.
inline Formula formula_of(const FormulaText& text, ExpressionSource& source) {
  const auto time = [](const std::optional<double>& seconds) {
    return seconds ? std::optional(in_ns(*seconds)) : std::nullopt;
  };
  Formula formula{
      text.quantifier, *Expression::parse(text.condition, source), {}, {}, time(text.within), time(text.lasting), {}};
  if (!text.after.empty()) formula.after = *Expression::parse(text.after, source);
  if (!text.except.empty()) formula.except = *Expression::parse(text.except, source);
  formula.span.from = text.from ? in_ns(*text.from) : 0;
  if (text.until) formula.span.until = in_ns(*text.until);
  return formula;
}

inline FormulaResult judged(const FormulaText& text, SampledSource& source) {
  const Formula formula = formula_of(text, source);
  FormulaJudge judge(formula);
  for (std::size_t tick = 0; tick < source.times.size(); ++tick)
    judge.take(source, static_cast<std::int64_t>(tick), source.times[tick]);
  return judge.finish();
}

}  // namespace rehearse::testing
