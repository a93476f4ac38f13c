#include "expectation_judge.h"

#include <fmt/format.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/clock.h"
#include "base/glob.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "expectation_text.h"

namespace rehearse {
namespace {

std::uint64_t to_ns(double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); }

/// The judged span of time, both ends included [ns].
struct Span {
  std::uint64_t from = 0;
  std::uint64_t until = std::numeric_limits<std::uint64_t>::max();
};

Span span_of(const Expectation& expectation) {
  Span span;
  if (expectation.from) span.from = to_ns(*expectation.from);
  if (expectation.until) span.until = to_ns(*expectation.until);
  return span;
}

std::string sample_text(const ViolatingSample& sample, const std::string& unit, const Expectation& expectation) {
  return fmt::format("{} at tick {} ({})", number_text(*sample.value, unit, expectation), sample.tick,
                     time_text(sample.time));
}

std::string event_text(const msg::Event& event) {
  return fmt::format("{} {}: {}", event.severity, event.source, event.text);
}

}  // namespace

/// True for the samples that count: for a moment all samples up to it, for a span all samples in it.
bool SeriesJudge::is_asked_for(std::uint64_t time) const {
  if (expectation_->at_end) return true;
  if (expectation_->at) return time <= to_ns(*expectation_->at);
  const Span span = span_of(*expectation_);
  return time >= span.from && time <= span.until;
}

SeriesJudge::SeriesJudge(const Expectation& expectation, const std::string& series)
    : expectation_(&expectation), condition_(*Expression::parse(condition_of(expectation, series), source_)) {}

void SeriesJudge::take(const TraceChannel& channel, std::size_t column) {
  const Expectation& e = *expectation_;
  for (std::size_t row = 0; row < channel.rows(); ++row) {
    const std::uint64_t time = channel.times[row];
    const double number = channel.number(row, column);
    any_number_ = any_number_ || !std::isnan(number);
    if (e.since && time <= to_ns(*e.since) && (!baseline_ || time >= baseline_time_)) {
      baseline_ = number;
      baseline_time_ = time;
    }
    if (!is_asked_for(time)) continue;
    source_.sample = number;
    source_.baseline = baseline_.value_or(0.0);
    // NaN violates each bound
    Judgement judgement = condition_.judged(source_, 0).worst;
    judgement.time = time;
    const double change = number - source_.baseline;
    const ViolatingSample sample{0, seconds_of(time), e.absolute ? std::abs(change) : change};
    if (!e.at && !e.at_end) {
      take_sample(sample, judgement);
    } else if (!latest_ || time >= latest_time_) {
      latest_ = sample;
      latest_judgement_ = judgement;
      latest_time_ = time;
    }
  }
}

void SeriesJudge::take_sample(const ViolatingSample& sample, const Judgement& judgement) {
  any_ = true;
  if (!decisive)
    decisive = judgement;
  else
    decisive = expectation_->sometime ? greater(*decisive, judgement) : lesser(*decisive, judgement);
  if (judgement.truth) {
    any_right_ = true;
    return;
  }
  if (!first) first = sample;
  if (!worst || judgement.margin < worst_margin_) worst = sample, worst_margin_ = judgement.margin;
  if (!nearest_ || judgement.margin > nearest_margin_) nearest_ = sample, nearest_margin_ = judgement.margin;
}

SeriesJudge::State SeriesJudge::finish() {
  const bool moment = expectation_->at || expectation_->at_end;
  const bool has_baseline = !expectation_->since || baseline_;
  if (!any_number_ || !has_baseline || (moment ? !latest_ : !any_)) {
    problem = any_number_ && !has_baseline ? fmt::format("there is no sample at {} s or before", *expectation_->since)
              : moment                     ? "there is no sample at that time or before"
                                           : "there is no sample in that span";
    first = worst = std::nullopt;
    decisive = std::nullopt;
    return State::not_judged;
  }
  if (moment) {
    decisive = latest_judgement_;
    if (decisive->truth) return State::holds;
    first = worst = latest_;
    return State::violated;
  }
  if (expectation_->sometime ? any_right_ : !first) return State::holds;
  if (expectation_->sometime) first = worst = nearest_;
  return State::violated;
}

void SeriesJudge::set_ticks(const TickClock& clock) {
  for (std::optional<ViolatingSample>* sample : {&first, &worst})
    if (*sample) (*sample)->tick = clock.tick_at(to_ns((*sample)->time));
}

void ExpectationJudge::take(const Trace& piece) {
  clock_.take(piece);
  take_times(piece);
  formulas_.take(piece);
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    if (expectations_[i].subject == Expectation::Subject::series)
      take_series(expectations_[i], piece, cases_[i]);
    else if (expectations_[i].subject != Expectation::Subject::expression)
      take_events(expectations_[i], piece, cases_[i]);
  }
}

void ExpectationJudge::take_times(const Trace& piece) {
  if (!clock_.empty()) return;
  for (const TraceChannel& channel : piece.channels()) {
    for (const std::uint64_t time : channel.times) {
      earliest_ = std::min(earliest_, time);
      latest_ = std::max(latest_, time);
    }
  }
}

void ExpectationJudge::take_series(const Expectation& e, const Trace& piece, Case& to) const {
  for (const auto& [name, place] : piece.series()) {
    if (!matches(e.pattern, name)) continue;
    const TraceChannel& channel = piece.channels()[place.channel];
    auto known = to.series.find(name);
    if (known == to.series.end())
      known = to.series
                  .emplace(name, JudgedSeries{SeriesJudge(e, name),
                                              unit_of(channel.metadata, channel.columns[place.column].element)})
                  .first;
    if (!e.angle || known->second.unit == "rad") known->second.judge.take(channel, place.column);
  }
}

void ExpectationJudge::take_events(const Expectation& e, const Trace& piece, Case& to) {
  const Span span = span_of(e);
  for (const msg::Event& event : piece.events()) {
    const std::uint64_t time = event.stamp.to_ns();
    if (to.event || time < span.from || time > span.until) continue;
    if (matches(e.pattern, event_text(event))) to.event = event;
  }
}

bool ExpectationJudge::found_all() const {
  for (std::size_t i = 0; i < cases_.size(); ++i)
    if (expectations_[i].subject == Expectation::Subject::series && cases_[i].series.empty()) return false;
  return !clock_.empty();
}

void ExpectationJudge::set_end(const Trace& last) {
  const std::uint64_t duration = earliest_ > latest_ ? 0 : latest_ - earliest_;
  end_time_ = clock_.empty() ? duration : clock_.last_time();
  next_time_ = end_time_ + std::max<std::uint64_t>(clock_.smallest_step(), 2);
  const auto outcome = RunFacts::of(last).outcome;
  ended_early_ = !outcome || outcome->failure;
}

std::vector<ExpectationResult> ExpectationJudge::finish(const Trace& last) {
  clock_.put_in_order();
  set_end(last);
  formulas_.finish(last);
  std::vector<ExpectationResult> results(expectations_.size());
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    if (expectations_[i].subject == Expectation::Subject::expression) {
      results[i] = formulas_.result(i, clock_, ended_early_);
      continue;
    }
    results[i].expectation = expectations_[i];
    results[i].text = text_of(expectations_[i], "");
    results[i].formula = formula_of(expectations_[i]);
    if (expectations_[i].subject == Expectation::Subject::series)
      judge_series(cases_[i], last, results[i]);
    else
      judge_events(cases_[i], results[i]);
  }
  return results;
}

/// The reason why the run is too short for the expectation; empty if it isn't.
std::string ExpectationJudge::missing_time(const Expectation& e) const {
  const double wanted = std::max({e.at.value_or(0.0), e.until.value_or(0.0), e.from.value_or(0.0)});
  // before the next tick no tick is missing; times of ticks are rounded
  if (to_ns(wanted) + 1 < next_time_ && !(e.at_end && ended_early_)) return {};
  return fmt::format("the run ended{} at {}", ended_early_ ? " early," : "", time_text(seconds_of(end_time_)));
}

void ExpectationJudge::tell(const Shortfall& shortfall, ExpectationResult& result) {
  result.holds = shortfall.text.empty();
  if (result.holds) return;
  result.undecided = shortfall.is_undecided;
  result.sentence =
      fmt::format("{}{}: {}", result.undecided ? "undecided: " : "expected ", result.text, shortfall.text);
}

void ExpectationJudge::judge_events(const Case& found, ExpectationResult& result) const {
  const bool wanted = result.expectation.subject == Expectation::Subject::event;
  if (found.event) {
    result.holds = wanted;
    if (wanted) return;
    const double time = seconds_of(found.event->stamp.to_ns());
    result.first = result.worst = ViolatingSample{found.event->tick, time, std::nullopt};
    result.sentence = fmt::format("expected {}: \"{}\" at tick {} ({})", result.text, event_text(*found.event),
                                  found.event->tick, time_text(time));
    return;
  }
  const std::string reason = missing_time(result.expectation);
  tell({reason.empty() && wanted ? "there is none" : reason, !reason.empty()}, result);
}

/// Counts a violating series. The earliest violation of several series is kept.
void ExpectationJudge::take(const SeriesJudge& judge, const std::string& name, const std::string& unit,
                            ExpectationResult& result, Tally& tally) {
  ++tally.violating;
  const bool earlier = judge.first && (!result.first || judge.first->time < result.first->time);
  if (!earlier && !result.series.empty()) return;
  result.series = name;
  result.first = judge.first;
  result.worst = judge.worst;
  tally.first_unit = unit;
  tally.problem = judge.problem;
}

void ExpectationJudge::judge_series(Case& found, const Trace& last, ExpectationResult& result) const {
  const Expectation& e = result.expectation;
  Tally tally;
  std::optional<Judgement> decisive;
  std::string unit_of_decisive;
  for (auto& [name, series] : found.series) {
    if (++tally.found == 1) tally.unit = series.unit;
    if (series.unit != tally.unit) tally.unit.clear();
    const bool is_angle = series.unit == "rad";
    if (e.angle && !is_angle)
      series.judge.problem =
          fmt::format("{} is no angle{}{}", name, series.unit.empty() ? "" : ", but in ", series.unit);
    const SeriesJudge::State state = e.angle && !is_angle ? SeriesJudge::State::violated : series.judge.finish();
    series.judge.set_ticks(clock_);
    if (state == SeriesJudge::State::violated) take(series.judge, name, series.unit, result, tally);
    if (state == SeriesJudge::State::not_judged) {
      result.not_judged.push_back(name);
      tally.not_judged = series.judge.problem;
    }
    const std::optional<Judgement>& of_series = series.judge.decisive;
    if (!of_series || (decisive && &lesser(*decisive, *of_series) != &*of_series)) continue;
    decisive = of_series;
    unit_of_decisive = series.unit;
  }
  if (decisive) set_closest(*decisive, unit_of_decisive, e.degrees, clock_, result);
  result.text = text_of(e, e.angle ? "rad" : tally.unit);
  const Shortfall shortfall = shortfall_of(result, tally, last);
  tell(shortfall.text.empty() ? Shortfall{missing_margin(result)} : shortfall, result);
}

ExpectationJudge::Shortfall ExpectationJudge::shortfall_of(ExpectationResult& result, const Tally& tally,
                                                           const Trace& last) const {
  const Expectation& e = result.expectation;
  if (tally.found == 0) {
    result.not_judged = unsampled_series(last, e.pattern);
    if (!result.not_judged.empty() && e.at_end && ended_early_) return {missing_time(e)};
    if (!result.not_judged.empty()) return {"not judged, " + without_sample_text(result.not_judged), true};
    const std::string near = last.nearest_series(e.pattern);
    return {fmt::format("the run has no such series{}{}", near.empty() ? "" : "; the nearest are ", near)};
  }
  const std::string reason = missing_time(e);
  if (!reason.empty() && (e.at || e.at_end)) {
    result.first = result.worst = std::nullopt;  // the last sample is from an earlier time
    return {reason, !e.at_end};
  }
  const bool may_come_true = e.sometime && !reason.empty();
  if (result.first && !may_come_true) return {violation_text(result, tally)};
  if (!tally.problem.empty()) return {tally.problem};
  if (!reason.empty() && (!e.sometime || tally.violating > 0)) {
    result.first = result.worst = std::nullopt;
    return {reason, true};
  }
  if (std::ssize(result.not_judged) == tally.found) return {"not judged, " + tally.not_judged, true};
  return {};
}

/// The first violating sample and the worst one.
std::string ExpectationJudge::violation_text(const ExpectationResult& result, const Tally& tally) {
  const Expectation& e = result.expectation;
  const bool several = e.pattern.find('*') != std::string::npos;
  std::string text = several ? result.series + " is " : "";
  if (e.sometime) text += "never, the nearest is ";
  text += sample_text(*result.first, tally.first_unit, e);
  if (result.worst->tick != result.first->tick) text += ", at worst " + sample_text(*result.worst, tally.first_unit, e);
  if (tally.violating > 1) text += fmt::format("; {} of {} series violate this", tally.violating, tally.found);
  return text;
}

}  // namespace rehearse
