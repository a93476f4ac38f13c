#include <fmt/format.h>
#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare_fields.h"
#include "compare_parts.h"
#include "counterpart.h"
#include "model/clock.h"
#include "scenario/trace_scenario.h"

namespace rehearse {

TickClock::TickClock(const Trace& trace) { read(trace); }

TickClock::TickClock(const Trace& piece, const TickClock& before) {
  if (!before.empty()) {
    times_.push_back(before.times_.back());
    ticks_.push_back(before.ticks_.back());
  }
  read(piece);
}

void TickClock::read(const Trace& trace) {
  for (const TraceChannel& channel : trace.channels()) {
    if (channel.type != msg::Tick::type_name || channel.columns.empty()) continue;
    const std::size_t column = column_of(channel, "tick");
    for (std::size_t row = 0; row < channel.rows(); ++row) {
      times_.push_back(channel.times[row]);
      ticks_.push_back(column < channel.columns.size() ? static_cast<std::int64_t>(channel.bits(row, column))
                                                       : static_cast<std::int64_t>(row));
    }
    break;
  }
}

std::int64_t TickClock::tick_at(std::uint64_t time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  return after == times_.begin() ? 0 : ticks_[static_cast<std::size_t>(after - times_.begin()) - 1];
}

bool TickClock::has(std::uint64_t time) const { return std::binary_search(times_.begin(), times_.end(), time); }

bool ChannelFindings::count(double difference, double tolerance, bool beyond) {
  ++result_.differing;
  if (beyond) ++result_.beyond;
  const double times = times_tolerance(difference, tolerance);
  // written so that a difference of NaN (a number against NaN) is the worst there is
  const bool worse = !(times <= worst_times_) || (times == worst_times_ && !(difference <= worst_difference_));
  return worse || !result_.first_bit || (beyond && !result_.first);
}

void ChannelFindings::describe(const Divergence& divergence, bool beyond) {
  mark(divergence);
  if (beyond && (!result_.first || comes_before(divergence, *result_.first))) result_.first = divergence;
  const double times = times_tolerance(divergence.difference, divergence.tolerance);
  if (times < worst_times_ || (times == worst_times_ && divergence.difference <= worst_difference_)) return;
  const auto or_infinite = [](double value) {
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  };
  worst_times_ = or_infinite(times);
  worst_difference_ = or_infinite(divergence.difference);
  result_.worst = divergence;
}

void ChannelFindings::structure(const Divergence& divergence) {
  if (!result_.first || comes_before(divergence, *result_.first)) result_.first = divergence;
  mark(divergence);
}

void ChannelFindings::mark(const Divergence& divergence) {
  if (!result_.first_bit || comes_before(divergence, *result_.first_bit)) result_.first_bit = divergence;
}

namespace {

/// The order in which things cause each other within one tick.
int rank_of(Stage stage) {
  switch (stage) {
    case Stage::physics: return 0;
    case Stage::sensors: return 1;
    case Stage::renderer: return 2;
    case Stage::inputs: return 3;
    case Stage::controller: return 4;
  }
  return 5;
}

}  // namespace

bool CompareOptions::takes(Stage stage) const {
  return stages.empty() || std::find(stages.begin(), stages.end(), stage) != stages.end();
}

bool comes_before(const Divergence& a, const Divergence& b) {
  return a.tick != b.tick ? a.tick < b.tick : rank_of(a.stage) < rank_of(b.stage);
}

std::size_t column_of(const TraceChannel& channel, std::string_view element) {
  const auto found = std::find_if(channel.columns.begin(), channel.columns.end(),
                                  [&](const TraceColumn& column) { return column.element == element; });
  return static_cast<std::size_t>(found - channel.columns.begin());
}

const std::string& series_of(const TraceChannel& channel, const TraceColumn& column) {
  return channel.type == msg::TFMessage::type_name ? column.element : column.series;
}

std::string_view series_of(const TraceChannel& channel) {
  const std::string_view topic = channel.topic;
  return topic.starts_with('/') ? topic.substr(1) : topic;
}

Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time) {
  const TickClock& clock =
      !traces.clock.has(time) && traces.actual_clock.has(time) ? traces.actual_clock : traces.clock;
  Divergence divergence;
  divergence.tick = clock.tick_at(time);
  if (traces.clock.empty() && traces.actual_clock.empty()) {  // not recorded by us: which message it is
    const auto message = std::lower_bound(channel.times.begin(), channel.times.end(), time);
    divergence.tick = message - channel.times.begin();
  }
  divergence.time = static_cast<double>(time) / 1e9;
  divergence.channel = channel.topic;
  divergence.stage = stage_of(channel.topic);
  return divergence;
}

namespace {

MatchedChannel match(const ComparedTraces& traces, const TraceChannel& golden, const TraceChannel& actual) {
  MatchedChannel matched{golden, actual, {}, golden.times == actual.times, {}, {}};
  std::size_t g = 0, a = 0;
  while (g < golden.times.size() || a < actual.times.size()) {
    const std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
    const std::uint64_t expected = g < golden.times.size() ? golden.times[g] : never;
    const std::uint64_t seen = a < actual.times.size() ? actual.times[a] : never;
    if (std::min(expected, seen) > traces.end) break;
    if (expected == seen) {
      matched.pairs.emplace_back(g++, a++);
      continue;
    }
    const bool lacking = expected < seen;
    std::vector<std::size_t>& lone = lacking ? matched.missing : matched.extra;
    if (!traces.in_a_lone_tick(std::min(expected, seen))) lone.push_back(lacking ? g : a);
    ++(lacking ? g : a);
  }
  return matched;
}

void report_unmatched(const ComparedTraces& traces, const MatchedChannel& channel, ChannelFindings& findings) {
  const auto report = [&](const TraceChannel& of, const std::vector<std::size_t>& messages, const char* what) {
    if (messages.empty()) return;
    Divergence divergence = place_of(traces, of, of.times[messages.front()]);
    divergence.note = messages.size() == 1
                          ? fmt::format("this message is {}", what)
                          : fmt::format("{} messages are {}; this is the first", messages.size(), what);
    findings.structure(divergence);
  };
  report(channel.golden, channel.missing, "missing");
  report(channel.actual, channel.extra, "extra: the golden hasn't that");
  findings.result().missing = static_cast<std::int64_t>(channel.missing.size());
  findings.result().extra = static_cast<std::int64_t>(channel.extra.size());
}

/// A checkpoint is what the state's hash is made of; events are compared as sequences.
bool is_compared_elsewhere(const TraceChannel& channel) {
  return channel.type == msg::Checkpoint::type_name || channel.type == msg::Event::type_name ||
         channel.type == msg::ContactChange::type_name;
}

/// The same contact, told from its other side: the scenario has its bodies in another order.
bool is_contact_reversed(const msg::ContactChange& a, const msg::ContactChange& b) {
  return a.stamp.to_ns() == b.stamp.to_ns() && a.tick == b.tick && a.begins == b.begins && a.link == b.other &&
         a.other == b.link;
}

/// Events whose bytes differ where their judge found nothing: what differs there is no part of a sequence.
void compare_event_fields(const ComparedTraces& traces, const MatchedChannel& channel, ChannelFindings& findings) {
  if (!channel.in_step) return;
  FieldJudge judge(traces, channel, findings);
  for (const auto& [golden, actual] : channel.pairs) {
    if (channel.golden.hashes[golden] == channel.actual.hashes[actual]) continue;
    if (channel.golden.type == msg::ContactChange::type_name &&
        is_contact_reversed(traces.golden.contact_changes()[golden], traces.actual.contact_changes()[actual])) {
      Divergence divergence = place_of(traces, channel.golden, channel.golden.times[golden]);
      divergence.note = "names the two links in the other order";
      findings.mark(divergence);
      continue;
    }
    const auto expected = traces.golden.payload(channel.golden, golden);
    const auto other = traces.actual.payload(channel.actual, actual);
    if (expected && other && !judge.compare(golden, *expected, *other)) judge.report_encoding(golden);
  }
}

/// One channel that both traces have. `differing_events`: the judge of events found something there.
void compare_channel(const ComparedTraces& traces, const TraceChannel& golden, const TraceChannel& actual,
                     bool differing_events, ChannelComparison& result) {
  ChannelFindings findings(result);
  const bool both_spoke = golden.messages() > 0 && actual.messages() > 0;
  if (golden.type != actual.type || (both_spoke && golden.columns.empty() != actual.columns.empty())) {
    Divergence divergence = place_of(traces, golden, golden.times.empty() ? 0 : golden.times.front());
    divergence.note = golden.type == actual.type ? "one trace has numbers here, the other has none"
                                                 : fmt::format("is of type {}, expected {}", actual.type, golden.type);
    return findings.structure(divergence);
  }
  const MatchedChannel matched = match(traces, golden, actual);
  if (is_compared_elsewhere(golden) && golden.type != msg::Checkpoint::type_name) {
    if (!differing_events) compare_event_fields(traces, matched, findings);
    return;
  }
  report_unmatched(traces, matched, findings);
  if (is_compared_elsewhere(golden) || matched.pairs.empty()) return;
  if (golden.columns.empty()) return compare_payloads(traces, matched, findings);
  compare_numbers(traces, matched, findings);
  compare_rests(traces, matched, findings);
}

/// Ticks that both runs have. The message that closes a run holds the state after the last tick, and is none itself.
std::int64_t compared_ticks(const ComparedTraces& traces) {
  std::int64_t messages = 0;
  for (const std::uint64_t time : traces.clock.times())
    if (time <= traces.end && traces.actual_clock.has(time)) ++messages;
  std::int64_t recorded = messages;
  if (const auto outcome = RunFacts::of(traces.golden).outcome) recorded = outcome->ticks.value_or(messages);
  return std::min(messages, recorded);
}

Agreement agreement_of(const Comparison& comparison) {
  if (!comparison.within) return Agreement::beyond;
  if (comparison.equal) return Agreement::equal;
  const bool all_noise = comparison.differing > 0 && comparison.in_noise == comparison.differing;
  return all_noise ? Agreement::in_noise : Agreement::within;
}

/// Sums up what was found in the channels.
void conclude(Comparison& comparison, std::vector<ChannelComparison> channels) {
  const auto take = [](std::optional<Divergence>& best, const std::optional<Divergence>& other) {
    if (other && (!best || comes_before(*other, *best))) best = other;
  };
  const auto badness = [](const Divergence& d) {
    if (std::isnan(d.difference)) return std::numeric_limits<double>::infinity();
    if (d.difference > 0.0 && d.tolerance == 0.0) return 1.0;  // what has to be exact can't be worse than anything
    return times_tolerance(d.difference, d.tolerance);
  };
  std::set<std::string> differing;
  for (ChannelComparison& channel : channels) {
    comparison.values += channel.values;
    if (channel.of_events) comparison.events += channel.values;
    comparison.differing += channel.differing;
    comparison.in_noise += channel.in_noise;
    comparison.beyond += channel.beyond;
    comparison.blanked += channel.blanked;
    take(comparison.first, channel.first);
    take(comparison.first_bit, channel.first_bit);
    if (channel.worst && (!comparison.worst || badness(*channel.worst) > badness(*comparison.worst)))
      comparison.worst = channel.worst;
    if (channel.first_bit) differing.insert(channel.channel);
  }
  for (const ChannelComparison& channel : channels)
    if (!channel.of_events && differing.insert(channel.channel).second)
      comparison.equal_channels.push_back(channel.channel);
  for (ChannelComparison& channel : channels)
    (channel.first_bit ? comparison.channels : comparison.same).push_back(std::move(channel));
  comparison.equal = !comparison.first_bit;
  comparison.within = !comparison.first;
  comparison.words_alone = comparison.within && !comparison.equal &&
                           std::ranges::all_of(comparison.channels, [](const ChannelComparison& channel) {
                             return channel.channel == run_topics::events;
                           });
  comparison.agreement = agreement_of(comparison);
  std::stable_sort(
      comparison.channels.begin(), comparison.channels.end(),
      [](const ChannelComparison& a, const ChannelComparison& b) { return comes_before(*a.first_bit, *b.first_bit); });
}

/// A part of the loop that is compared makes some of the channel's values. Checkpoints are compared by the state's
/// hash; a run of some parts only needs none.
bool takes(const CompareOptions& options, const TraceChannel& channel) {
  if (channel.type == msg::Tick::type_name) return true;  // each element decides
  if (channel.type == msg::Checkpoint::type_name) return options.stages.empty();
  return options.takes(stage_of(channel.topic));
}

/// Nothing is compared, and this is why.
Comparison refusal(const Diagnostic& reason) {
  Comparison comparison;
  comparison.agreement = Agreement::beyond;
  Divergence& first = comparison.first.emplace();
  first.stage = Stage::inputs;
  first.note = fmt::format("{}: {}; {}", reason.file, reason.message, reason.hint);
  comparison.first_bit = comparison.first;
  return comparison;
}

}  // namespace

std::string_view to_string(Agreement agreement) {
  switch (agreement) {
    case Agreement::equal: return "equal";
    case Agreement::in_noise: return "in noise";
    case Agreement::within: return "within";
    case Agreement::beyond: return "beyond";
  }
  return "";
}

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options) {
  for (const Trace* trace : {&golden, &actual})
    if (const auto known = check_version(*trace); !known) return refusal(known.errors()[0]);
  ComparedTraces traces{golden, actual, rules, options, TickClock(golden), TickClock(actual)};
  if (options.until) traces.end = static_cast<std::uint64_t>(std::llround(std::max(0.0, *options.until) * 1e9));
  Comparison comparison;
  std::vector<ChannelComparison> channels;
  const auto add = [&](const std::string& topic) -> ChannelComparison& {
    ChannelComparison& result = channels.emplace_back();
    result.channel = topic;
    result.stage = stage_of(topic);
    return result;
  };
  const auto taken = [&](const TraceChannel& channel) {
    return takes(options, channel) && !isnt_compared(channel, rules);
  };
  compare_ticks(traces, add(run_topics::tick));
  std::vector<ChannelComparison> of_events;  // after the values: of two findings of a tick, a value tells more
  compare_events(
      traces,
      [&](const std::string& topic) -> ChannelComparison& {
        ChannelComparison& result = of_events.emplace_back();
        result.channel = topic;
        result.stage = stage_of(topic);
        result.of_events = true;
        return result;
      },
      comparison.event_differences);
  compare_lone_channels(traces, taken, add, comparison.remarks);
  for (const TraceChannel& channel : golden.channels()) {
    const TraceChannel* other = counterpart(golden, channel, actual);
    if (!taken(channel) || !other) continue;
    ChannelComparison& result = add(channel.topic);
    const bool differing_events = std::any_of(of_events.begin(), of_events.end(), [&](const ChannelComparison& events) {
      return events.channel == channel.topic && events.first_bit;
    });
    compare_channel(traces, channel, *other, differing_events, result);
    if (is_picture(channel)) comparison.pictures += result.values;
    const bool by_hash = channel.type == msg::Checkpoint::type_name;  // nobody looked into it: it isn't equal either
    if (by_hash && !result.first_bit) channels.pop_back();
  }
  if (options.takes(Stage::controller))
    if (std::string remark = remark_on_variables(traces); !remark.empty())
      comparison.remarks.push_back(std::move(remark));
  channels.insert(channels.end(), of_events.begin(), of_events.end());
  comparison.ticks = compared_ticks(traces);
  conclude(comparison, std::move(channels));
  compare_provenance(traces, comparison);
  comparison.warnings = unmatched_rules(traces);
  return comparison;
}

Result<std::vector<ToleranceRule>> tolerances_of(const Trace& trace) {
  if (!trace.find_attachment("scenario.yaml")) return std::vector<ToleranceRule>();
  auto reader = mcap::Reader::open(trace.file());
  if (!reader) return reader.errors();
  auto scenario = scenario_of(**reader);
  if (!scenario) return scenario.errors();
  return scenario->tolerances;
}

}  // namespace rehearse
