#include <fmt/format.h>
#include <rehearse/clock.h>
#include <rehearse/compare.h>
#include <rehearse/mcap.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "compare_parts.h"
#include "trace_scenario.h"

namespace rehearse {

TickClock::TickClock(const Trace& trace) {
  for (const TraceChannel& channel : trace.channels()) {
    if (channel.type != msg::Tick::type_name || channel.columns.empty()) continue;
    std::size_t column = 0;
    while (column < channel.columns.size() && channel.columns[column].element != "tick") ++column;
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

bool Findings::count(double difference, double tolerance, bool beyond) {
  ++result_.differing;
  if (beyond) ++result_.beyond;
  const double times = times_tolerance(difference, tolerance);
  // written so that a difference of NaN (a number against NaN) is the worst there is
  const bool worse = !(times <= worst_times_) || (times == worst_times_ && !(difference <= worst_difference_));
  return worse || !result_.first_bit || (beyond && !result_.first);
}

void Findings::describe(const Divergence& divergence, bool beyond) {
  if (!result_.first_bit) result_.first_bit = divergence;
  if (beyond && !result_.first) result_.first = divergence;
  const double times = times_tolerance(divergence.difference, divergence.tolerance);
  if (times < worst_times_ || (times == worst_times_ && divergence.difference <= worst_difference_)) return;
  const auto or_infinite = [](double value) {
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  };
  worst_times_ = or_infinite(times);
  worst_difference_ = or_infinite(divergence.difference);
  result_.worst = divergence;
}

void Findings::structure(const Divergence& divergence) {
  if (!result_.first || comes_before(divergence, *result_.first)) result_.first = divergence;
  mark(divergence);
}

void Findings::mark(const Divergence& divergence) {
  if (!result_.first_bit || comes_before(divergence, *result_.first_bit)) result_.first_bit = divergence;
}

double times_tolerance(double difference, double tolerance) {
  if (difference == 0.0) return 0.0;
  return tolerance > 0.0 ? difference / tolerance : std::numeric_limits<double>::infinity();
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

Stage stage_of(std::string_view topic, std::string_view element) {
  const std::string_view kind = topic.substr(topic.rfind('/') + 1);
  if (topic == "/tick") {
    if (element == "state_hash") return Stage::physics;
    if (element == "input_hash") return Stage::inputs;
    return Stage::controller;
  }
  if (topic == "/tf" && element.find("/scan/") != std::string_view::npos) return Stage::sensors;
  if (topic.find("/input/") != std::string_view::npos || topic == "/joy") return Stage::inputs;
  if (topic.find("/output/") != std::string_view::npos || topic == "/events")
    return Stage::controller;
  if (kind == "image" || kind == "depth" || kind == "camera_info") return Stage::renderer;
  if (kind == "wrench" || kind == "imu" || kind == "scan" || kind == "points" || kind == "measured_joints" || kind == "contact")
    return Stage::sensors;
  return Stage::physics;
}

std::string unit_of(const TraceChannel& channel, const std::string& element) {
  const auto stated = [&](const std::string& key) -> const std::string* {
    const auto found = channel.metadata.find(key);
    return found == channel.metadata.end() ? nullptr : &found->second;
  };
  if (const std::string* unit = stated("unit:" + element)) return *unit;
  for (std::size_t begin = 0; begin < element.size();) {
    const std::size_t end = std::min(element.find('/', begin), element.size());
    if (const std::string* unit = stated("unit:" + element.substr(begin, end - begin))) return *unit;
    begin = end + 1;
  }
  const std::string* unit = stated("unit");
  return unit ? *unit : "";
}

Divergence place_of(const ComparedTraces& traces, const TraceChannel& channel, std::uint64_t time) {
  const TickClock& clock =
      !traces.clock.has(time) && traces.actual_clock.has(time) ? traces.actual_clock : traces.clock;
  Divergence divergence;
  divergence.tick = clock.tick_at(time);
  divergence.time = static_cast<double>(time) * 1e-9;
  divergence.channel = channel.topic;
  divergence.stage = stage_of(channel.topic);
  return divergence;
}

namespace {

MatchedChannel match(const TraceChannel& golden, const TraceChannel& actual, std::uint64_t end) {
  MatchedChannel matched{golden, actual, {}, golden.times == actual.times, {}, {}};
  std::size_t g = 0, a = 0;
  while (g < golden.times.size() || a < actual.times.size()) {
    const std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
    const std::uint64_t expected = g < golden.times.size() ? golden.times[g] : never;
    const std::uint64_t seen = a < actual.times.size() ? actual.times[a] : never;
    if (std::min(expected, seen) > end) break;
    if (expected == seen) {
      matched.pairs.emplace_back(g++, a++);
    } else if (expected < seen) {
      matched.missing.push_back(g++);
    } else {
      matched.extra.push_back(a++);
    }
  }
  return matched;
}

void report_unmatched(const ComparedTraces& traces, const MatchedChannel& channel, Findings& findings) {
  const auto report = [&](const TraceChannel& of, const std::vector<std::size_t>& messages, const char* what) {
    if (messages.empty()) return;
    Divergence divergence = place_of(traces, of, of.times[messages.front()]);
    divergence.note = messages.size() == 1 ? fmt::format("a message {}", what)
                                           : fmt::format("{} messages {}, this is the first", messages.size(), what);
    findings.structure(divergence);
  };
  report(channel.golden, channel.missing, "of the golden is missing");
  report(channel.actual, channel.extra, "is extra: the golden hasn't it");
  findings.result().missing = static_cast<std::int64_t>(channel.missing.size());
  findings.result().extra = static_cast<std::int64_t>(channel.extra.size());
}

bool only_describes_itself(const TraceChannel& channel) {
  // A checkpoint is what the state's hash is made of; events are compared as a sequence.
  return channel.type == msg::Checkpoint::type_name || channel.type == msg::Event::type_name;
}

/// One channel that both traces have.
void compare_channel(const ComparedTraces& traces, const TraceChannel& golden, const TraceChannel& actual,
                     ChannelComparison& result) {
  Findings findings(result);
  const bool both_speak = !golden.times.empty() && !actual.times.empty();  // one that says nothing has no columns either
  if (golden.type != actual.type || (both_speak && golden.columns.empty() != actual.columns.empty())) {
    Divergence divergence = place_of(traces, golden, golden.times.empty() ? 0 : golden.times.front());
    divergence.note = golden.type == actual.type ? "one trace has numbers here, the other has none"
                                                 : fmt::format("is of type {}, expected {}", actual.type, golden.type);
    return findings.structure(divergence);
  }
  const MatchedChannel matched = match(golden, actual, traces.end);
  report_unmatched(traces, matched, findings);
  if (only_describes_itself(golden) || matched.pairs.empty()) return;
  if (golden.columns.empty())
    compare_payloads(traces, matched, findings);
  else
    compare_numbers(traces, matched, findings);
}

void report_lone_channel(const ComparedTraces& traces, const TraceChannel& channel, const char* note,
                         ChannelComparison& result) {
  Divergence divergence = place_of(traces, channel, channel.times.empty() ? 0 : channel.times.front());
  divergence.note = note;
  Findings(result).structure(divergence);
}

std::string text_of(const msg::Event& event) {
  return fmt::format("tick {}, {}, {}: {}", event.tick, event.severity, event.source, event.text);
}

/// What happened, one after the other: the first that isn't what happened in the golden.
void compare_events(const ComparedTraces& traces, ChannelComparison& result) {
  const std::vector<msg::Event>&golden = traces.golden.events(), &actual = traces.actual.events();
  Findings findings(result);
  for (std::size_t i = 0; i < std::max(golden.size(), actual.size()); ++i) {
    const bool there = i < actual.size(), expected = i < golden.size();
    if (there && expected && text_of(golden[i]) == text_of(actual[i])) continue;
    const msg::Event& event = there && (!expected || actual[i].tick <= golden[i].tick) ? actual[i] : golden[i];
    if (event.stamp.to_ns() > traces.end) return;  // only one of the runs came so far
    Divergence divergence;
    divergence.tick = event.tick;
    divergence.time = static_cast<double>(event.stamp.to_ns()) * 1e-9;
    divergence.channel = result.channel;
    divergence.stage = Stage::controller;
    divergence.note =
        fmt::format("event {} is {}, expected {}", i + 1, there ? "\"" + text_of(actual[i]) + "\"" : "missing",
                    expected ? "\"" + text_of(golden[i]) + "\"" : "none");
    return findings.structure(divergence);
  }
}

std::string failure_of(const Trace& trace) {
  const mcap::StringMap* outcome = trace.find_metadata("rehearse.outcome");
  if (!outcome) return "the recording was cut off";
  const auto failure = outcome->find("failure");
  return failure == outcome->end() ? "" : failure->second;
}

/// One run is longer than the other: everything is compared up to the shorter one's end, and this says so.
void compare_lengths(ComparedTraces& traces, ChannelComparison& result) {
  if (traces.clock.empty() || traces.actual_clock.empty()) return;
  const std::uint64_t golden_end = traces.clock.last_time(), actual_end = traces.actual_clock.last_time();
  const std::uint64_t asked = std::exchange(traces.end, std::min({golden_end, actual_end, traces.end}));
  if (golden_end == actual_end || asked <= std::min(golden_end, actual_end)) return;
  const bool early = actual_end < golden_end;
  const std::string failure = failure_of(early ? traces.actual : traces.golden);
  Divergence divergence;
  divergence.tick = (early ? traces.actual_clock : traces.clock).tick_at(traces.end);
  divergence.time = static_cast<double>(traces.end) * 1e-9;
  divergence.channel = result.channel;
  divergence.stage = failure.starts_with("controller") ? Stage::controller
                     : failure.empty()                 ? Stage::inputs
                                                       : Stage::physics;
  divergence.note = fmt::format("the {} ends here{}, the {} goes on to tick {}", early ? "run" : "golden",
                                failure.empty() ? "" : " (" + failure + ")", early ? "golden" : "run",
                                (early ? traces.clock : traces.actual_clock).tick_at(std::max(golden_end, actual_end)));
  Findings(result).structure(divergence);
}

/// Whether a fact of the provenance decides how numbers are rounded.
bool is_arithmetic(const std::string& fact) {
  constexpr std::string_view facts[] = {"rehearse", "physics", "libc", "compiler", "renderer"};
  return fact.starts_with("pinned.") || std::find(std::begin(facts), std::end(facts), fact) != std::end(facts);
}

/// What isn't as it was when the golden was recorded.
void compare_circumstances(const Trace& golden, const Trace& actual, const CompareOptions& options,
                           Comparison& comparison) {
  std::vector<std::string>& remarks = comparison.remarks;
  const auto same = [](const mcap::Attachment& a, const mcap::Attachment& b) {
    return std::equal(a.data.begin(), a.data.end(), b.data.begin(), b.data.end());
  };
  for (const mcap::Attachment& attachment : golden.attachments()) {
    if (attachment.name.ends_with(".report")) continue;
    const mcap::Attachment* other = actual.find_attachment(attachment.name);
    if (other && same(attachment, *other)) continue;
    comparison.changed_files.push_back(attachment.name);
    if (!other)
      remarks.push_back(fmt::format("{} was part of the golden's run only", attachment.name));
    else
      remarks.push_back(fmt::format("{} is not what it was when the golden was recorded", attachment.name));
  }
  const mcap::StringMap *before = golden.find_metadata("rehearse"), *now = actual.find_metadata("rehearse");
  if (!before || !now) return;
  for (const auto& [fact, value] : *before) {
    if (fact.starts_with("controller.") && !options.takes(Stage::controller)) continue;
    const auto found = now->find(fact);
    if (found != now->end() && found->second == value) continue;
    remarks.push_back(
        fmt::format("{} was \"{}\" and is \"{}\"", fact, value, found == now->end() ? "" : found->second));
    comparison.same_arithmetic = comparison.same_arithmetic && !is_arithmetic(fact);
  }
}

/// Ticks that both runs have. The message that closes a run holds the state after the last tick, and is none itself.
std::int64_t compared_ticks(const ComparedTraces& traces) {
  std::int64_t messages = 0;
  while (messages < std::ssize(traces.clock.times()) && traces.clock.times()[messages] <= traces.end) ++messages;
  std::int64_t recorded = messages;
  if (const mcap::StringMap* outcome = traces.golden.find_metadata("rehearse.outcome")) {
    const auto ticks = outcome->find("ticks");
    if (ticks != outcome->end())
      std::from_chars(ticks->second.data(), ticks->second.data() + ticks->second.size(), recorded);
  }
  return std::min(messages, recorded);
}

/// Sums up what was found in the channels.
void conclude(Comparison& comparison, std::vector<ChannelComparison> channels) {
  const auto take = [](std::optional<Divergence>& best, const std::optional<Divergence>& other) {
    if (other && (!best || comes_before(*other, *best))) best = other;
  };
  const auto badness = [](const Divergence& d) { return times_tolerance(d.difference, d.tolerance); };
  for (ChannelComparison& channel : channels) {
    comparison.values += channel.values;
    comparison.differing += channel.differing;
    comparison.beyond += channel.beyond;
    take(comparison.first, channel.first);
    take(comparison.first_bit, channel.first_bit);
    if (channel.worst && (!comparison.worst || badness(*channel.worst) > badness(*comparison.worst)))
      comparison.worst = channel.worst;
    if (channel.first_bit) comparison.channels.push_back(std::move(channel));
  }
  comparison.equal = !comparison.first_bit;
  comparison.within = !comparison.first;
  std::stable_sort(
      comparison.channels.begin(), comparison.channels.end(),
      [](const ChannelComparison& a, const ChannelComparison& b) { return comes_before(*a.first_bit, *b.first_bit); });
}

/// A part of the loop that is compared makes some of the channel's values. Checkpoints are compared by the state's hash;
/// a run of some parts only needs none.
bool takes(const CompareOptions& options, const TraceChannel& channel) {
  if (channel.type == msg::Tick::type_name) return true;  // each element decides
  if (channel.type == msg::Checkpoint::type_name) return options.stages.empty();
  return options.takes(stage_of(channel.topic));
}

}  // namespace

Comparison compare(const Trace& golden, const Trace& actual, const std::vector<ToleranceRule>& rules,
                   const CompareOptions& options) {
  ComparedTraces traces{golden, actual, rules, options, TickClock(golden), TickClock(actual)};
  if (options.until) traces.end = static_cast<std::uint64_t>(std::llround(std::max(0.0, *options.until) * 1e9));
  Comparison comparison;
  std::vector<ChannelComparison> channels;
  const auto result_for = [&](const std::string& topic) -> ChannelComparison& {
    ChannelComparison& result = channels.emplace_back();
    result.channel = topic;
    result.stage = stage_of(topic);
    return result;
  };
  compare_lengths(traces, result_for("/tick"));
  if (options.takes(stage_of("/events"))) compare_events(traces, result_for("/events"));
  std::set<std::string_view> compared;
  for (const TraceChannel& channel : golden.channels()) {
    if (!compared.insert(channel.topic).second || !takes(options, channel)) continue;
    ChannelComparison& result = result_for(channel.topic);
    if (const TraceChannel* other = actual.find_channel(channel.topic))
      compare_channel(traces, channel, *other, result);
    else
      report_lone_channel(traces, channel, "the channel is missing", result);
    if (is_picture(channel)) comparison.pictures += result.values;
  }
  for (const TraceChannel& channel : actual.channels())
    if (compared.insert(channel.topic).second && takes(options, channel))
      report_lone_channel(traces, channel, "the channel is extra: the golden hasn't it", result_for(channel.topic));
  comparison.ticks = compared_ticks(traces);
  conclude(comparison, std::move(channels));
  compare_circumstances(golden, actual, options, comparison);
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
