#include "formula_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include "base/clock.h"
#include "core/expression/unit.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/declared_source.h"
#include "expectation_text.h"

namespace rehearse {
namespace {

std::uint64_t nanoseconds(double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); }

std::optional<std::uint64_t> nanoseconds(const std::optional<double>& seconds) {
  return seconds ? std::optional(nanoseconds(*seconds)) : std::nullopt;
}

Quantifier quantifier_of(const Expectation& expectation) {
  switch (expectation.quantifier) {
    case Expectation::Quantifier::always: return Quantifier::always;
    case Expectation::Quantifier::eventually: return Quantifier::eventually;
    case Expectation::Quantifier::never: break;
  }
  return Quantifier::never;
}

Result<Expression> parse_condition(const std::string& text, const Expectation& expectation, ExpressionSource& source) {
  auto parsed = Expression::parse(text, source);
  if (!parsed) return in_expression(parsed.errors().front(), text, expectation.place, false);
  return parsed;
}

/// Other than FormulaResult, the result states places as ticks.
ViolatingSample sample_of(const TickJudgement& at, const TickClock& clock) {
  ViolatingSample sample{clock.tick_at(at.time), seconds_of(static_cast<std::int64_t>(at.time)), std::nullopt};
  if (at.judgement.comparison != Judgement::nothing) sample.value = at.judgement.value;
  return sample;
}

}  // namespace

Result<Formula> parse_formula(const Expectation& e, ExpressionSource& source) {
  auto condition = REHEARSE_TRY(parse_condition(e.expression, e, source));
  Formula formula{quantifier_of(e), std::move(condition), {}, {}, nanoseconds(e.delay), nanoseconds(e.lasting), {}};
  for (auto [text, to] : {std::pair(&e.after, &formula.after), std::pair(&e.except, &formula.except)}) {
    if (text->empty()) continue;
    auto parsed = REHEARSE_TRY(parse_condition(*text, e, source));
    *to = std::move(parsed);
  }
  if (e.from) formula.span.from = nanoseconds(*e.from);
  if (e.until) formula.span.until = nanoseconds(*e.until);
  return formula;
}

std::optional<Diagnostic> mistake_in(const Expectation& expectation, const Trace& names) {
  if (expectation.subject != Expectation::Subject::expression) return std::nullopt;
  RunSource source(names);
  source.set_limits(expectation.limits);
  const auto parsed = parse_formula(expectation, source);
  return parsed ? std::nullopt : std::optional(parsed.errors().front());
}

void set_closest(const Judgement& judgement, const std::string& unit, bool degrees, const TickClock& clock,
                 ExpectationResult& result) {
  if (!std::isfinite(judgement.margin) || judgement.comparison == Judgement::nothing) return;
  const double margin = judgement.margin + 0.0;  // == has the margin -0.0 where it holds, which is 0 in texts
  result.margin = margin;
  ClosestPlace& closest = result.closest.emplace();
  closest.margin = margin;
  closest.value = judgement.value;
  closest.bound = judgement.bound;
  closest.unit = unit;
  closest.text = quantities_text(judgement.value, judgement.bound, unit, degrees);
  closest.tick = clock.tick_at(judgement.time);
  closest.time = static_cast<double>(judgement.time) / 1e9;
  if (judgement.bound != 0.0) closest.share = margin / std::abs(judgement.bound);
}

FormulaRun::FormulaRun(const std::vector<Expectation>& expectations, const Trace* names)
    : expectations_(expectations), names_(names) {
  for (std::size_t i = 0; i < expectations.size(); ++i)
    if (expectations[i].subject == Expectation::Subject::expression) cases_.emplace_back().index = i;
}

void FormulaRun::parse(const Trace& names) {
  source_.emplace(names);
  for (Case& of : cases_) {
    source_->set_limits(expectations_[of.index].limits);
    auto parsed = parse_formula(expectations_[of.index], *source_);
    if (!parsed) {
      of.mistake = parsed.errors().front();
      continue;
    }
    of.formula = std::make_unique<Formula>(*std::move(parsed));
    of.judge = std::make_unique<FormulaJudge>(*of.formula);
    source_->prepare(of.formula->condition);
    if (of.formula->after) source_->prepare(*of.formula->after);
    if (of.formula->except) source_->prepare(*of.formula->except);
  }
}

void FormulaRun::pass(std::int64_t tick, std::uint64_t time) {
  for (const Case& of : cases_)
    if (of.judge) of.judge->take(*source_, tick, time);
}

void FormulaRun::take(const Trace& piece) {
  if (empty()) return;
  if (!source_) parse(names_ ? *names_ : piece);
  source_->take(piece, [this](std::int64_t tick, std::uint64_t time) { pass(tick, time); });
}

void FormulaRun::finish(const Trace& names) {
  if (empty()) return;
  if (!source_) parse(names);
  last_time_ = source_->finish([this](std::int64_t tick, std::uint64_t time) { pass(tick, time); });
  RunSource all(names);
  for (Case& of : cases_) {
    all.set_limits(expectations_[of.index].limits);
    const auto parsed = parse_formula(expectations_[of.index], all);
    lacked_names_ = lacked_names_ || parsed.ok() == of.mistake.has_value();
    if (!parsed) of.mistake = parsed.errors().front();
    finish(of, names);
  }
  lacked_names_ = lacked_names_ || all.found() != source_->found();
}

void FormulaRun::finish(Case& of, const Trace& names) {
  if (of.mistake) {
    for (const std::string& name : expectations_[of.index].names)
      for (std::string& series : unsampled_series(names, name)) of.unsampled.push_back(std::move(series));
    return;
  }
  std::set<std::size_t> read;
  for (const Expression* part : {&of.formula->condition, of.formula->after ? &*of.formula->after : nullptr,
                                 of.formula->except ? &*of.formula->except : nullptr})
    if (part) std::ranges::copy(part->series(), std::inserter(read, read.end()));
  for (const std::size_t series : read)
    if (!source_->has_sample(series)) of.unsampled.push_back(source_->name_of(series));
  of.result = of.judge->finish(
      std::ranges::any_of(read, [this](std::size_t series) { return source_->begins_with_nan(series); }));
}

bool FormulaRun::any_mistake() const {
  return std::ranges::any_of(cases_, [](const Case& of) { return of.mistake.has_value(); });
}

std::string FormulaRun::sample_text(const Case& of, const TickJudgement& at, const TickClock& clock) const {
  const std::string place =
      fmt::format("at tick {} ({})", clock.tick_at(at.time), time_text(seconds_of(static_cast<std::int64_t>(at.time))));
  if (at.judgement.comparison == Judgement::nothing) return "not so " + place;
  const std::string values = of.formula->condition.comparison_text(at.judgement);
  if (at.judgement.time == at.time) return fmt::format("{} {}", values, place);
  return fmt::format("not so {}: {} at tick {}", place, values, clock.tick_at(at.judgement.time));
}

void FormulaRun::tell_violation(const Case& of, const TickClock& clock, bool ended_early,
                                ExpectationResult& result) const {
  const FormulaResult& found = of.result;
  const std::string end = fmt::format("the run ended{} at {}", ended_early ? " early," : "",
                                      time_text(seconds_of(static_cast<std::int64_t>(last_time_.value_or(0)))));
  if (found.state == FormulaResult::State::undecided) {
    result.undecided = true;
    result.sentence = fmt::format("undecided: {}: {}", result.text, end);
    if (found.first)
      result.sentence += fmt::format(", within the time from tick {} on", clock.tick_at(found.first->time));
    return;
  }
  std::string text;
  if (found.is_nan) {
    text = fmt::format("a number is NaN at tick {} ({})", clock.tick_at(found.first->time),
                       time_text(seconds_of(static_cast<std::int64_t>(found.first->time))));
  } else {
    const bool is_some =
        result.expectation.quantifier == Expectation::Quantifier::eventually && result.expectation.after.empty();
    const bool is_compared = found.first->judgement.comparison != Judgement::nothing;
    if (is_some) text = is_compared ? "never, the nearest is " : "never";
    if (!is_some || is_compared) text += sample_text(of, *found.first, clock);
    if (!is_some && found.worst->time != found.first->time && found.worst->judgement.comparison != Judgement::nothing)
      text += ", at worst " + sample_text(of, *found.worst, clock);
  }
  result.sentence = fmt::format("expected {}: {}", result.text, text);
  result.first = sample_of(*found.first, clock);
  result.worst = found.worst ? sample_of(*found.worst, clock) : *result.first;
}

std::string FormulaRun::not_judged_text(const Case& of) const {
  if (!of.result.any_tick) return "there is no tick in that span";
  if (!of.unsampled.empty()) return "not judged, " + without_sample_text(of.unsampled);
  return "not judged, the span ends before the first samples of its series";
}

ExpectationResult FormulaRun::result(std::size_t index, const TickClock& clock, bool ended_early) const {
  const Case& of = *std::ranges::find(cases_, index, &Case::index);
  ExpectationResult result;
  result.expectation = expectations_[index];
  result.text = text_of(result.expectation, "");
  result.formula = formula_of(result.expectation);
  result.not_judged = of.unsampled;
  if (of.mistake && !of.unsampled.empty()) {
    result.undecided = true;
    result.sentence = fmt::format("undecided: {}: not judged, {}", result.text, without_sample_text(of.unsampled));
    return result;
  }
  if (of.mistake) {
    result.problem = of.mistake;
    result.sentence = fmt::format("expected {}: {} ({})", result.text,
                                  of.mistake->message.substr(0, of.mistake->message.find('\n')), of.mistake->hint);
    return result;
  }
  const FormulaResult& found = of.result;
  if (!found.is_judged && found.state == FormulaResult::State::undecided && !found.first) {
    result.undecided = true;
    result.sentence = fmt::format("undecided: {}: {}", result.text, not_judged_text(of));
    return result;
  }
  if (found.decisive) {
    const Judgement& judgement = found.decisive->judgement;
    const Expression& condition = of.formula->condition;
    set_closest(judgement, condition.unit_of(judgement.comparison), condition.is_in_degrees(judgement.comparison),
                clock, result);
  }
  result.holds = found.state == FormulaResult::State::holds;
  if (!result.holds) {
    tell_violation(of, clock, ended_early, result);
  } else if (const std::string missing = missing_margin(result); !missing.empty()) {
    result.holds = false;
    result.sentence = fmt::format("expected {}: {}", result.text, missing);
  }
  return result;
}

}  // namespace rehearse
