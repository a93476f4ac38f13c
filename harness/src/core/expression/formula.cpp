#include "formula.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rehearse {
namespace {

/// The condition with `for`, `never` and `except`.
SignalPtr core_of(const Formula& formula) {
  SignalPtr core = signal_of(formula.condition);
  if (formula.lasting && !formula.except) core = lasting_of(std::move(core), *formula.lasting);
  if (formula.quantifier == Quantifier::never) core = negation_of(std::move(core));
  if (!formula.except) return core;
  SignalPtr excepted = recent_of(guard_of(signal_of(*formula.except)), formula.lasting.value_or(0));
  return formula.quantifier == Quantifier::eventually
             ? conjunction_of(std::move(core), negation_of(std::move(excepted)))
             : disjunction_of(std::move(core), std::move(excepted));
}

/// The condition within the time after a tick.
SignalPtr windowed(const Formula& formula, SignalPtr core) {
  if (!formula.within) return core;
  return formula.quantifier == Quantifier::never ? lasting_of(std::move(core), *formula.within)
                                                 : coming_of(std::move(core), *formula.within);
}

}  // namespace

FormulaJudge::FormulaJudge(const Formula& formula) : formula_(formula) {
  SignalPtr body = windowed(formula, core_of(formula));
  if (!formula.after) {
    of_some_ = formula.quantifier == Quantifier::eventually;
    whole_ = std::move(body);
    return;
  }
  SignalPtr rises = rise_of(signal_of(*formula.after), formula.span, triggered_);
  if (formula.quantifier == Quantifier::eventually && !formula.within) {
    whole_ = std::move(body);
    rises_ = std::move(rises);
    return;
  }
  const bool is_of_rises =
      formula.within || (formula.lasting && !formula.except && formula.quantifier == Quantifier::always);
  SignalPtr when = is_of_rises ? std::move(rises) : once_of(std::move(rises));
  whole_ = disjunction_of(negation_of(std::move(when)), std::move(body));
}

void FormulaJudge::take(ExpressionSource& source, std::int64_t tick, std::uint64_t time) {
  if (last_) step_ = std::min(step_.value_or(time - *last_), time - *last_);
  last_ = time;
  whole_->take(source, tick, time);
  if (rises_) rises_->take(source, tick, time);
  take_ready();
}

/// False before the span of the condition of `after`. Before it becomes true, nothing is demanded.
bool FormulaJudge::note_trigger(const Judged& rise) {
  note_blank(rise);
  is_judged_ = is_judged_ || (rise.is_known() && !rise.best.truth && !may_rise_);
  return !rise.is_before_span();
}

void FormulaJudge::take_ready() {
  const auto next = [](Signal& signal) {
    Judged judged = std::move(signal.ready.front());
    signal.ready.pop_front();
    return judged;
  };
  while (!whole_->ready.empty() && (!rises_ || !rises_->ready.empty())) {
    const Judged judged = next(*whole_);
    const std::optional<Judged> rise = rises_ ? std::optional(next(*rises_)) : std::nullopt;
    if (!formula_.span.has(judged.time)) continue;
    any_ = true;
    if (rise && !note_trigger(*rise)) continue;
    if (!note(judged)) {
      if (rise) note_rise(*rise, judged.time);
      continue;
    }
    if (rise)
      fold_after_rise(*rise, judged);
    else if (of_some_)
      fold_some(judged);
    else
      fold_all(judged);
  }
}

void FormulaJudge::note_blank(const Judged& judged) {
  if (!judged.is_known() && judged.causes.blank && !first_blank_)
    first_blank_ = TickJudgement{judged.time, judged.worst};
}

bool FormulaJudge::note(const Judged& judged) {
  note_blank(judged);
  is_judged_ = is_judged_ || judged.is_known() || judged.causes.nan || !judged.causes.missing;
  return !judged.is_before_span();
}

void FormulaJudge::note_unknown(const Judged& judged) {
  if (judged.is_known()) return;
  std::optional<TickJudgement>& first = judged.causes.cut ? first_cut_ : first_nan_;
  if (!first) first = TickJudgement{judged.time, judged.worst};
}

void FormulaJudge::fold_all(const Judged& judged) {
  if (!judged.best.truth && !first_violation_) first_violation_ = TickJudgement{judged.time, judged.best};
  note_unknown(judged);
  const auto keep_lesser = [&](std::optional<TickJudgement>& kept, const Judgement& next) {
    if (!kept || &lesser(kept->judgement, next) == &next) kept = TickJudgement{judged.time, next};
  };
  keep_lesser(bounds_.worst, judged.worst);
  keep_lesser(bounds_.best, judged.best);
}

void FormulaJudge::fold_some(const Judged& judged) {
  note_unknown(judged);
  const auto keep_greater = [&](std::optional<TickJudgement>& kept, const Judgement& next) {
    if (!kept || &greater(kept->judgement, next) == &next) kept = TickJudgement{judged.time, next};
  };
  keep_greater(bounds_.worst, judged.worst);
  keep_greater(bounds_.best, judged.best);
}

void FormulaJudge::note_rise(const Judged& rise, std::uint64_t time) {
  if (rise.best.truth) {
    may_rise_ = true;
    bounds_.worst.reset();
  }
  if (rise.worst.truth) {
    rises_surely_ = true;
    bounds_.best.reset();
    first_nan_ = first_cut_ = std::nullopt;
    last_rise_ = time;
  }
}

void FormulaJudge::fold_after_rise(const Judged& rise, const Judged& judged) {
  note_rise(rise, judged.time);
  if (may_rise_) fold_some(judged);
}

FormulaResult FormulaJudge::unknown_result(FormulaResult result, bool is_over) const {
  const bool may_come_true = is_of_one_tick() && (first_cut_ || !is_over);
  result.is_nan = first_nan_ && !may_come_true;
  result.state = result.is_nan ? FormulaResult::State::violated : FormulaResult::State::undecided;
  result.first = result.is_nan || !first_cut_ ? first_nan_ : first_cut_;
  return result;
}

std::uint64_t FormulaJudge::next_time() const {
  return last_.value_or(0) + std::max(step_.value_or(0), 3 * window_slack);
}

FormulaResult FormulaJudge::finish(bool blank_is_nan) {
  whole_->end(next_time());
  if (rises_) rises_->end(next_time());
  take_ready();
  const bool has_blank_sample = blank_is_nan && first_blank_;
  if (has_blank_sample && (!first_nan_ || first_blank_->time < first_nan_->time)) first_nan_ = first_blank_;
  const std::uint64_t until = formula_.span.until;
  const bool is_over = until == TimeSpan().until || until + window_slack < next_time();  // no tick of it is missing
  const bool is_vacuous = rises_ && !may_rise_;
  FormulaResult result;
  result.any_tick = any_;
  result.is_judged = is_judged_ && (is_vacuous || bounds_.worst);
  result.triggered = triggered_;
  if (!result.is_judged && first_nan_) return unknown_result(std::move(result), is_over);
  if (!result.is_judged) {
    result.state = FormulaResult::State::undecided;
    return result;
  }
  const bool holds = is_vacuous || (bounds_.worst->judgement.truth && (is_of_one_tick() || !has_blank_sample));
  // of one tick: missing ticks may still make it true; of all ticks: nothing makes it true again
  const bool is_violated =
      !is_vacuous && !bounds_.best->judgement.truth && (!rises_ || rises_surely_) && (is_over || !is_of_one_tick());
  const auto margin_of = [](const std::optional<TickJudgement>& bound) {
    return bound && std::isfinite(bound->judgement.margin) ? bound : std::nullopt;
  };
  if (is_violated) {
    result.state = FormulaResult::State::violated;
    result.first = first_violation_ ? first_violation_ : bounds_.best;
    if (rises_) result.first->time = last_rise_;
    result.worst = bounds_.best;
    result.decisive = margin_of(bounds_.best);
    return result;
  }
  if (!holds && (first_nan_ || first_cut_)) return unknown_result(std::move(result), is_over);
  if (!is_over && (!holds || !of_some_)) {
    result.state = FormulaResult::State::undecided;
    return result;
  }
  if (!holds) return unknown_result(std::move(result), is_over);
  result.decisive = is_vacuous ? std::nullopt : margin_of(bounds_.worst);
  return result;
}

}  // namespace rehearse
