#include <fmt/format.h>
#include <rehearse/expectation.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>
#include <rehearse/tolerance.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "compare_parts.h"

namespace rehearse {
namespace {

std::uint64_t to_ns(double seconds) { return static_cast<std::uint64_t>(std::llround(seconds * 1e9)); }

/// When a run ended, and whether it was meant to.
struct RunEnd {
  std::uint64_t time = 0;  // of its last tick [ns]
  bool early = false;      // it failed, or was cut off
};

RunEnd end_of(const Trace& run, const TickClock& clock) {
  RunEnd end;
  end.time = clock.empty() ? to_ns(run.duration()) : clock.last_time();
  const mcap::StringMap* outcome = run.find_metadata("rehearse.outcome");
  end.early = outcome == nullptr || outcome->count("failure") != 0;
  return end;
}

/// Nanoseconds are what a trace has; a double of them may have more digits.
std::string time_text(double seconds) { return fmt::format("{:.12g} s", seconds); }

double seconds(std::uint64_t time) { return static_cast<double>(time) * 1e-9; }

/// The span of time that counts, both ends included [ns].
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

/// How a number of the expectation is told, with its unit.
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
  const bool is_told = e.since && e.from == e.since;  // as the time since when it changes
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

/// How far a value is out of the bounds; not above 0 if it is right. NaN is as far as can be.
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
bool is_right(const Expectation& e, double value) {
  const double excess = excess_of(e, value);
  return e.near ? excess <= 0.0 : excess < 0.0;
}

/// One series of the run under one expectation.
class SeriesJudge {
 public:
  SeriesJudge(const Expectation& expectation, const TraceChannel& channel, std::size_t column, const TickClock& clock)
      : expectation_(expectation), channel_(channel), column_(column), clock_(clock) {}

  /// False if it doesn't hold; then `first`, or `problem` if it is a matter of no sample.
  bool judge();

  std::optional<ViolatingSample> first, worst;
  std::string problem;

 private:
  std::optional<std::size_t> row_at(std::uint64_t time) const;
  bool judge_moment();
  bool judge_span();
  double bounded(std::size_t row) const;
  ViolatingSample sample(std::size_t row) const;

  const Expectation& expectation_;
  const TraceChannel& channel_;
  std::size_t column_;
  const TickClock& clock_;
  double baseline_ = 0.0;
};

/// The latest message at that time or before.
std::optional<std::size_t> SeriesJudge::row_at(std::uint64_t time) const {
  std::optional<std::size_t> latest;
  for (std::size_t row = 0; row < channel_.rows(); ++row)
    if (channel_.times[row] <= time && (!latest || channel_.times[row] >= channel_.times[*latest])) latest = row;
  return latest;
}

double SeriesJudge::bounded(std::size_t row) const {
  const double value = channel_.number(row, column_) - baseline_;
  return expectation_.absolute ? std::abs(value) : value;
}

ViolatingSample SeriesJudge::sample(std::size_t row) const {
  const std::uint64_t time = channel_.times[row];
  return {clock_.tick_at(time), seconds(time), bounded(row)};
}

bool SeriesJudge::judge() {
  if (expectation_.since) {
    const auto row = row_at(to_ns(*expectation_.since));
    if (!row) {
      problem = fmt::format("there is no sample at {} s or before", *expectation_.since);
      return false;
    }
    baseline_ = channel_.number(*row, column_);
  }
  return expectation_.at || expectation_.at_end ? judge_moment() : judge_span();
}

bool SeriesJudge::judge_moment() {
  const std::uint64_t last = std::numeric_limits<std::uint64_t>::max();
  const auto row = row_at(expectation_.at ? to_ns(*expectation_.at) : last);
  if (!row) {
    problem = "there is no sample then or before";
    return false;
  }
  if (is_right(expectation_, bounded(*row))) return true;
  first = worst = sample(*row);
  return false;
}

bool SeriesJudge::judge_span() {
  const Span span = span_of(expectation_);
  std::optional<std::size_t> first_row, worst_row, nearest_row;
  bool any_right = false, any = false;
  double worst_excess = 0.0, nearest_excess = 0.0;
  for (std::size_t row = 0; row < channel_.rows(); ++row) {
    if (channel_.times[row] < span.from || channel_.times[row] > span.until) continue;
    any = true;
    const double value = bounded(row);
    const double excess = excess_of(expectation_, value);
    if (is_right(expectation_, value)) {
      any_right = true;
      continue;
    }
    if (!first_row) first_row = row;
    if (!worst_row || excess > worst_excess) worst_row = row, worst_excess = excess;
    if (!nearest_row || excess < nearest_excess) nearest_row = row, nearest_excess = excess;
  }
  if (!any) {
    problem = "there is no sample in that span";
    return false;
  }
  if (expectation_.sometime ? any_right : !first_row) return true;
  first = sample(expectation_.sometime ? *nearest_row : *first_row);
  worst = sample(expectation_.sometime ? *nearest_row : *worst_row);
  return false;
}

/// One run under all expectations.
class RunJudge {
 public:
  explicit RunJudge(const Trace& run) : run_(run), clock_(run), end_(end_of(run, clock_)) {}

  ExpectationResult judge(const Expectation& expectation) const;

 private:
  /// What the series that match have come to.
  struct Tally {
    std::int64_t found = 0, violating = 0;
    std::string unit;        // of all of them; empty if there are several
    std::string first_unit;  // of the one that is violated first
    std::string problem;     // of it, if it is a matter of no sample
  };

  std::string missing_time(const Expectation& expectation) const;
  void judge_events(ExpectationResult& result) const;
  void judge_series(ExpectationResult& result) const;
  std::string violation_of(ExpectationResult& result, const Tally& tally) const;
  static void take(const SeriesJudge& judge, const std::string& name, const std::string& unit,
                   ExpectationResult& result, Tally& tally);

  const Trace& run_;
  TickClock clock_;
  RunEnd end_;
};

ExpectationResult RunJudge::judge(const Expectation& expectation) const {
  ExpectationResult result;
  result.expectation = expectation;
  result.text = text_of(expectation, "");
  if (expectation.subject == Expectation::Subject::series)
    judge_series(result);
  else
    judge_events(result);
  return result;
}

/// Why the run can't say what is asked, if it is too short for that.
std::string RunJudge::missing_time(const Expectation& e) const {
  const double wanted = std::max({e.at.value_or(0.0), e.until.value_or(0.0), e.from.value_or(0.0)});
  if (to_ns(wanted) <= end_.time && !(e.at_end && end_.early)) return {};
  return fmt::format("the run ended{} at {}", end_.early ? " early," : "", time_text(seconds(end_.time)));
}

void RunJudge::judge_events(ExpectationResult& result) const {
  const Expectation& e = result.expectation;
  const Span span = span_of(e);
  const bool wanted = e.subject == Expectation::Subject::event;
  result.holds = !wanted;
  for (const msg::Event& event : run_.events()) {
    const std::uint64_t time = event.stamp.to_ns();
    const std::string text = fmt::format("{} {}: {}", event.severity, event.source, event.text);
    if (time < span.from || time > span.until || !matches(e.pattern, text)) continue;
    result.holds = wanted;
    if (wanted) return;
    result.first = result.worst = ViolatingSample{event.tick, seconds(time), std::nullopt};
    result.sentence =
        fmt::format("expected {}: \"{}\" at tick {} ({})", result.text, text, event.tick, time_text(seconds(time)));
    return;
  }
  const std::string reason = missing_time(e);
  result.holds = result.holds && reason.empty();
  if (!result.holds)
    result.sentence = fmt::format("expected {}: {}", result.text, reason.empty() ? "there is none" : reason);
}

/// The first violation of several series counts.
void RunJudge::take(const SeriesJudge& judge, const std::string& name, const std::string& unit,
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

void RunJudge::judge_series(ExpectationResult& result) const {
  const Expectation& e = result.expectation;
  Tally tally;
  for (const auto& [name, place] : run_.series()) {
    if (!matches(e.pattern, name)) continue;
    const TraceChannel& channel = run_.channels()[place.channel];
    const std::string unit = unit_of(channel, channel.columns[place.column].element);
    if (++tally.found == 1) tally.unit = unit;
    if (unit != tally.unit) tally.unit.clear();
    SeriesJudge judge(e, channel, place.column, clock_);
    const bool is_angle = unit == "rad";
    if (e.angle && !is_angle)
      judge.problem = fmt::format("{} is no angle{}{}", name, unit.empty() ? "" : ", but in ", unit);
    if ((e.angle && !is_angle) || !judge.judge()) take(judge, name, unit, result, tally);
  }
  result.text = text_of(e, e.angle ? "rad" : tally.unit);
  const std::string what = violation_of(result, tally);
  result.holds = what.empty();
  if (!result.holds) result.sentence = fmt::format("expected {}: {}", result.text, what);
}

/// What isn't as expected; empty if all is.
std::string RunJudge::violation_of(ExpectationResult& result, const Tally& tally) const {
  const Expectation& e = result.expectation;
  if (tally.found == 0) {
    const std::string near = run_.nearest_series(e.pattern);
    return fmt::format("the run has no such series{}{}", near.empty() ? "" : "; the nearest are ", near);
  }
  const std::string reason = missing_time(e);
  if (!reason.empty() && (e.at || e.at_end)) {
    result.first = result.worst = std::nullopt;  // what is there last says nothing
    return reason;
  }
  if (!result.first) return reason.empty() ? tally.problem : reason;
  const bool several = e.pattern.find('*') != std::string::npos;
  std::string text = several ? result.series + " is " : "";
  if (e.sometime) text += "never, the nearest is ";
  text += sample_text(*result.first, tally.first_unit, e);
  if (result.worst->tick != result.first->tick) text += ", at worst " + sample_text(*result.worst, tally.first_unit, e);
  if (tally.violating > 1) text += fmt::format("; so {} of {} series", tally.violating, tally.found);
  return text;
}

}  // namespace

std::vector<ExpectationResult> judge_expectations(const std::vector<Expectation>& expectations, const Trace& run) {
  std::vector<ExpectationResult> results;
  if (expectations.empty()) return results;
  const RunJudge judge(run);
  for (const Expectation& expectation : expectations) results.push_back(judge.judge(expectation));
  return results;
}

const ExpectationResult* first_violation(const std::vector<ExpectationResult>& results) {
  // that something never came is known only in the end
  const auto known_at = [](const ExpectationResult& result) {
    const bool at_once = result.first && !result.expectation.sometime;
    return at_once ? result.first->time : std::numeric_limits<double>::infinity();
  };
  const ExpectationResult* first = nullptr;
  for (const ExpectationResult& result : results)
    if (!result.holds && (!first || known_at(result) < known_at(*first))) first = &result;
  return first;
}

Divergence divergence_of(const ExpectationResult& violation, const Trace& run) {
  Divergence divergence;
  const TickClock clock(run);
  const auto place = run.find_series(violation.series);
  if (violation.first) {
    divergence.tick = violation.first->tick;
    divergence.time = violation.first->time;
  } else if (!clock.empty()) {
    divergence.tick = clock.tick_at(clock.last_time());
    divergence.time = seconds(clock.last_time());
  }
  if (place) {
    const TraceChannel& channel = run.channels()[place->channel];
    divergence.channel = channel.topic;
    divergence.element = channel.columns[place->column].element;
    divergence.unit = unit_of(channel, divergence.element);
    divergence.stage = stage_of(divergence.channel, divergence.element);
  } else if (violation.expectation.subject != Expectation::Subject::series) {
    divergence.channel = "/events";
    divergence.stage = stage_of(divergence.channel);
  }
  if (violation.first && violation.first->value) divergence.actual = *violation.first->value;
  divergence.note = violation.sentence;
  return divergence;
}

std::string verdict(const std::vector<ExpectationResult>& results) {
  if (results.empty()) return {};
  const ExpectationResult* first = first_violation(results);
  if (first == nullptr)
    return results.size() == 1 ? fmt::format("the expectation holds: {}", results[0].text)
                               : fmt::format("all {} expectations hold", results.size());
  const auto violated = std::count_if(results.begin(), results.end(), [](const auto& result) { return !result.holds; });
  if (violated == 1) return first->sentence;
  return fmt::format("{}; {} more of {} expectations {} violated", first->sentence, violated - 1, results.size(),
                     violated == 2 ? "is" : "are");
}

std::string violation_lines(const std::vector<ExpectationResult>& results) {
  std::string text;
  for (const ExpectationResult& result : results)
    if (!result.holds)
      text += fmt::format("\n{}:{}: {}", result.expectation.place.file, result.expectation.place.line, result.sentence);
  return text;
}

std::optional<double> horizon_of(const Scenario& scenario, std::optional<double> estimated) {
  return scenario.horizon ? scenario.horizon : estimated;
}

}  // namespace rehearse
