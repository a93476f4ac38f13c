#include "expectation_judge.h"

#include <fmt/format.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/kinds/channel_name.h"
#include "core/mcap/glob.h"
#include "core/trace/run_facts.h"
#include "model/clock.h"

namespace rehearse {
namespace {

std::uint64_t to_ns(double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); }

/// A trace has nanoseconds; a double of them may have more digits.
std::string time_text(double seconds) { return fmt::format("{:.12g} s", seconds); }

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

/// A number as the expectation states numbers, with its unit.
std::string number_text(double value, const std::string& unit, const Expectation& expectation) {
  if (expectation.degrees && unit == "rad") return fmt::format("{:.6g} deg", value * 180.0 / std::numbers::pi);
  return fmt::format("{:.6g}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::string bounds_text(const Expectation& e, const std::string& unit) {
  if (e.near) return fmt::format("within {} of {}", number_text(*e.within, unit, e), number_text(*e.near, unit, e));
  std::string text;
  if (e.above) text = "above " + number_text(*e.above, unit, e);
  if (e.below) text += (text.empty() ? "below " : " and below ") + number_text(*e.below, unit, e);
  return text;
}

std::string span_text(const Expectation& e) {
  if (e.at_end) return " at the end";
  if (e.at) return fmt::format(" at {} s", *e.at);
  std::string text = e.sometime ? " at some time" : "";
  const bool is_told = e.since && e.from == e.since;  // as the beginning of the change
  if (e.from && e.until && !is_told) return text + fmt::format(" from {} s until {} s", *e.from, *e.until);
  if (e.until) return text + fmt::format(" until {} s", *e.until);
  if (e.from && !is_told) return text + fmt::format(" from {} s on", *e.from);
  return text;
}

std::string text_of(const Expectation& e, const std::string& unit) {
  if (e.subject == Expectation::Subject::event) return fmt::format("an event \"{}\"{}", e.pattern, span_text(e));
  if (e.subject == Expectation::Subject::no_event) return fmt::format("no event \"{}\"{}", e.pattern, span_text(e));
  std::string quantity = e.pattern;
  if (e.since) quantity = fmt::format("the change of {} since {} s", quantity, *e.since);
  if (e.absolute) quantity = "the magnitude of " + quantity;
  return fmt::format("{} {}{}", quantity, bounds_text(e, unit), span_text(e));
}

std::string sample_text(const ViolatingSample& sample, const std::string& unit, const Expectation& expectation) {
  return fmt::format("{} at tick {} ({})", number_text(*sample.value, unit, expectation), sample.tick,
                     time_text(sample.time));
}

std::string event_text(const msg::Event& event) {
  return fmt::format("{} {}: {}", event.severity, event.source, event.text);
}

/// The distance of a value from the bounds, outside of them; not above 0 if the value is right. Infinity for NaN.
double excess_of(const Expectation& e, double value) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (std::isnan(value)) return infinite;
  if (e.near) return std::abs(value - *e.near) - *e.within;
  double excess = -infinite;
  if (e.above) excess = std::max(excess, *e.above - value);
  if (e.below) excess = std::max(excess, value - *e.below);
  return excess;
}

/// The bounds themselves are right with near and within, and wrong with above and below.
bool is_right(const Expectation& e, double excess) { return e.near ? excess <= 0.0 : excess < 0.0; }

}  // namespace

/// True for the samples that count: for a moment all samples up to it, for a span all samples in it.
bool SeriesJudge::is_asked_for(std::uint64_t time) const {
  if (expectation_->at_end) return true;
  if (expectation_->at) return time <= to_ns(*expectation_->at);
  const Span span = span_of(*expectation_);
  return time >= span.from && time <= span.until;
}

void SeriesJudge::take(const TraceChannel& channel, std::size_t column) {
  const Expectation& e = *expectation_;
  for (std::size_t row = 0; row < channel.rows(); ++row) {
    const std::uint64_t time = channel.times[row];
    const double number = channel.number(row, column);
    if (e.since && time <= to_ns(*e.since) && (!baseline_ || time >= baseline_time_)) {
      baseline_ = number;
      baseline_time_ = time;
    }
    if (!is_asked_for(time)) continue;
    const double change = number - baseline_.value_or(0.0);
    const ViolatingSample sample{0, seconds_of(time), e.absolute ? std::abs(change) : change};
    if (!e.at && !e.at_end) {
      take_sample(sample);
    } else if (!latest_ || time >= latest_time_) {
      latest_ = sample;
      latest_time_ = time;
    }
  }
}

void SeriesJudge::take_sample(const ViolatingSample& sample) {
  any_ = true;
  const double excess = excess_of(*expectation_, *sample.value);
  margin = expectation_->sometime ? std::max(margin.value_or(-excess), -excess)
                                  : std::min(margin.value_or(-excess), -excess);
  if (is_right(*expectation_, excess)) {
    any_right_ = true;
    return;
  }
  if (!first) first = sample;
  if (!worst || excess > worst_excess_) worst = sample, worst_excess_ = excess;
  if (!nearest_ || excess < nearest_excess_) nearest_ = sample, nearest_excess_ = excess;
}

bool SeriesJudge::finish() {
  const bool moment = expectation_->at || expectation_->at_end;
  if (expectation_->since && !baseline_) {
    problem = fmt::format("there is no sample at {} s or before", *expectation_->since);
    first = worst = std::nullopt;
    return false;
  }
  if (moment ? !latest_ : !any_) {
    problem = moment ? "there is no sample at that time or before" : "there is no sample in that span";
    return false;
  }
  if (moment) {
    margin = -excess_of(*expectation_, *latest_->value);
    if (is_right(*expectation_, -*margin)) return true;
    first = worst = latest_;
    return false;
  }
  if (expectation_->sometime ? any_right_ : !first) return true;
  if (expectation_->sometime) first = worst = nearest_;
  return false;
}

void SeriesJudge::set_ticks(const TickClock& clock) {
  for (std::optional<ViolatingSample>* sample : {&first, &worst})
    if (*sample) (*sample)->tick = clock.tick_at(to_ns((*sample)->time));
}

void ExpectationJudge::take(const Trace& piece) {
  clock_.take(piece);
  take_times(piece);
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    if (expectations_[i].subject == Expectation::Subject::series)
      take_series(expectations_[i], piece, cases_[i]);
    else
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
                  .emplace(name, JudgedSeries{SeriesJudge(e),
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
  const auto outcome = RunFacts::of(last).outcome;
  ended_early_ = !outcome || outcome->failure;
}

std::vector<ExpectationResult> ExpectationJudge::finish(const Trace& last) {
  clock_.put_in_order();
  set_end(last);
  std::vector<ExpectationResult> results(expectations_.size());
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    results[i].expectation = expectations_[i];
    results[i].text = text_of(expectations_[i], "");
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
  if (to_ns(wanted) <= end_time_ && !(e.at_end && ended_early_)) return {};
  return fmt::format("the run ended{} at {}", ended_early_ ? " early," : "", time_text(seconds_of(end_time_)));
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
  result.holds = !wanted && reason.empty();
  if (!result.holds)
    result.sentence = fmt::format("expected {}: {}", result.text, reason.empty() ? "there is none" : reason);
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
  for (auto& [name, series] : found.series) {
    if (++tally.found == 1) tally.unit = series.unit;
    if (series.unit != tally.unit) tally.unit.clear();
    const bool is_angle = series.unit == "rad";
    if (e.angle && !is_angle)
      series.judge.problem =
          fmt::format("{} is no angle{}{}", name, series.unit.empty() ? "" : ", but in ", series.unit);
    const bool holds = (!e.angle || is_angle) && series.judge.finish();
    series.judge.set_ticks(clock_);
    if (!holds) take(series.judge, name, series.unit, result, tally);
    if (series.judge.margin)
      result.margin = std::min(result.margin.value_or(*series.judge.margin), *series.judge.margin);
  }
  result.text = text_of(e, e.angle ? "rad" : tally.unit);
  const std::string what = violation_of(result, tally, last);
  result.holds = what.empty();
  if (!result.holds) result.sentence = fmt::format("expected {}: {}", result.text, what);
}

/// The violation in words; empty if the expectation holds.
std::string ExpectationJudge::violation_of(ExpectationResult& result, const Tally& tally, const Trace& last) const {
  const Expectation& e = result.expectation;
  if (tally.found == 0) {
    const std::string near = last.nearest_series(e.pattern);
    return fmt::format("the run has no such series{}{}", near.empty() ? "" : "; the nearest are ", near);
  }
  const std::string reason = missing_time(e);
  if (!reason.empty() && (e.at || e.at_end)) {
    result.first = result.worst = std::nullopt;  // the last sample is from an earlier time
    return reason;
  }
  if (!result.first) return reason.empty() ? tally.problem : reason;
  const bool several = e.pattern.find('*') != std::string::npos;
  std::string text = several ? result.series + " is " : "";
  if (e.sometime) text += "never, the nearest is ";
  text += sample_text(*result.first, tally.first_unit, e);
  if (result.worst->tick != result.first->tick) text += ", at worst " + sample_text(*result.worst, tally.first_unit, e);
  if (tally.violating > 1) text += fmt::format("; {} of {} series violate this", tally.violating, tally.found);
  return text;
}

}  // namespace rehearse
