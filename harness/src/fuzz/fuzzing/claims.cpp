#include "claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/clock.h"
#include "core/check/formula_judge.h"
#include "core/expression/joint_series.h"
#include "core/expression/name_search.h"

namespace rehearse {

RunTable::RunTable(std::vector<NamedSeries> series, double time_step)
    : series_(std::move(series)), time_step_(time_step) {
  for (const NamedSeries& one : series_) names_.push_back(one.name);
}

void RunTable::add_tick() {
  const std::size_t size = rows_.size(), width = series_.size();
  rows_.resize(size + width, std::numeric_limits<double>::quiet_NaN());
  if (size > 0)
    std::copy_n(rows_.begin() + static_cast<std::ptrdiff_t>(size - width), width,
                rows_.begin() + static_cast<std::ptrdiff_t>(size));
}

Result<std::size_t> RunTable::find_series(std::string_view name) { return find_name(name, names_, "series"); }

Result<std::vector<std::size_t>> RunTable::find_links(std::string_view name) {
  return error(fmt::format("a fuzz test has no contacts and no orientations, and so no link '{}'", name));
}

Result<std::size_t> RunTable::find_joint_series(std::string_view joint, std::string_view quantity, bool of_command) {
  return find_joint_name(joint, quantity, of_command, names_);
}

Result<JointLimit> RunTable::find_limit(std::string_view joint, std::string_view limit) {
  const auto found = limits_.find(fmt::format("{} {}", joint, limit));
  if (found == limits_.end()) return error(fmt::format("the model has no {} limit of a joint '{}'", limit, joint));
  return JointLimit{found->second.value, found->second.unit};
}

double RunTable::time_at(std::int64_t tick) const { return time_of(tick, time_step_); }

std::optional<std::int64_t> RunTable::tick_of(double time, std::int64_t tick) const {
  const auto found = static_cast<std::int64_t>(std::floor(time / time_step_ + 1e-9));
  if (found < 0 || found > tick) return std::nullopt;
  return found;
}

ExpressionSource::Sampled RunTable::sampled(std::size_t series, std::int64_t tick, CommandSide) const {
  for (std::int64_t before = tick; before >= 0; --before)
    if (!std::isnan(number(series, before))) return Sampled::yes;
  return Sampled::no;
}

ExpressionSource::Sampled RunTable::sampled_at(std::size_t series, double time, std::int64_t tick) const {
  const auto at = tick_of(time, tick);
  return at ? sampled(series, *at, CommandSide::recorded) : Sampled::no;
}

double RunTable::value_at(std::size_t series, double time, std::int64_t tick) {
  const auto at = tick_of(time, tick);
  return at ? number(series, *at) : std::numeric_limits<double>::quiet_NaN();
}

namespace {

std::string text_of_claim(const Expectation& expectation) {
  switch (expectation.quantifier) {
    case Expectation::Quantifier::always: return "always: " + expectation.expression;
    case Expectation::Quantifier::eventually: return "eventually: " + expectation.expression;
    case Expectation::Quantifier::never: break;
  }
  return "never: " + expectation.expression;
}

std::uint64_t nanoseconds(double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); }

}  // namespace

Result<Claims> Claims::parse(const std::vector<Expectation>& expectations, RunTable& table) {
  Claims claims;
  claims.table_ = &table;
  for (const Expectation& expectation : expectations) {
    table.set_limits(expectation.limits);
    auto formula = parse_formula(expectation, table);
    if (!formula) {
      Diagnostic mistake = formula.errors().front();
      mistake.file.clear();  // the scenario of a fuzz test is in no file
      mistake.line = mistake.column = 0;
      return mistake;
    }
    claims.claims_.push_back(std::make_unique<Claim>(Claim{text_of_claim(expectation), *std::move(formula)}));
  }
  return claims;
}

ClaimResult Claims::judge(std::size_t claim) const {
  const Claim& of = *claims_[claim];
  FormulaJudge judge(of.formula);
  for (std::int64_t tick = 0; tick < table_->ticks(); ++tick)
    judge.take(*table_, tick, nanoseconds(table_->time_at(tick)));
  const FormulaResult found = judge.finish();
  ClaimResult result;
  if (found.decisive && std::isfinite(found.decisive->judgement.margin))
    result.margin = found.decisive->judgement.margin;
  if (found.state != FormulaResult::State::violated || !found.first) return result;
  result.holds = false;
  const double step = table_->ticks() > 1 ? table_->time_at(1) : 1.0;
  result.tick = std::llround(static_cast<double>(found.first->time) * 1e-9 / step);
  const Judgement& judgement = found.first->judgement;
  const std::string values =
      judgement.comparison == Judgement::nothing ? "not so" : of.formula.condition.comparison_text(judgement);
  result.sentence = fmt::format("expected {}: {} at tick {}", of.text, values, result.tick);
  return result;
}

}  // namespace rehearse
