// Comparison of events: contacts, limits and refusals as sequences that begin and end, messages as text.
#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cstdlib>

#include "compare_parts.h"
#include "event_sequences.h"
#include "mcap/glob.h"

namespace rehearse {
namespace {

constexpr std::size_t most_differences = 1000;  // number of listed differences

constexpr double never = std::numeric_limits<double>::infinity();  // distance of an event that only one run has

/// The allowed distance of an event without a rule [ticks].
int default_ticks(EventKind kind) { return kind == EventKind::refusal ? 0 : 1; }

std::string_view verb_of(const EventEdge& edge) { return edge.begins ? "begins" : "ends"; }

/// Judges one sequence of events, and blanks the numbers between events that are early or late within a rule's
/// tolerance.
class SequenceJudge {
 public:
  SequenceJudge(ComparedTraces& traces, const std::string& name, const EventSequence& sequence,
                ChannelFindings& findings, std::vector<EventDifference>& differences)
      : traces_(traces), name_(name), sequence_(sequence), findings_(findings), differences_(differences) {
    const auto stated = tolerance_of(name, "", traces.rules).ticks;
    allowed_ = stated.value_or(default_ticks(sequence.source.kind));
    blanks_ = stated && *stated > 0;
  }

  void judge() {
    const std::vector<EventPair> pairs = align(sequence_.golden, sequence_.actual);
    findings_.result().values += static_cast<std::int64_t>(pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const EventPair& pair = pairs[i];
      if (pair.golden && pair.actual) {
        judge_pair(sequence_.golden[*pair.golden], sequence_.actual[*pair.actual]);
      } else if (is_short(pairs, i)) {
        judge_short(edge_of(pair), edge_of(pairs[i + 1]), pair.golden.has_value());
        ++i;
      } else {
        judge_lone(edge_of(pair), pair.golden.has_value());
      }
    }
  }

 private:
  const EventEdge& edge_of(const EventPair& pair) const {
    return pair.golden ? sequence_.golden[*pair.golden] : sequence_.actual[*pair.actual];
  }

  /// True for two events that only one trace has, a beginning and an end or the reverse, within the allowed distance.
  bool is_short(const std::vector<EventPair>& pairs, std::size_t i) const {
    if (i + 1 == pairs.size() || (pairs[i + 1].golden && pairs[i + 1].actual)) return false;
    if (pairs[i].golden.has_value() != pairs[i + 1].golden.has_value()) return false;
    return edge_of(pairs[i + 1]).tick - edge_of(pairs[i]).tick <= allowed_;
  }

  void judge_pair(const EventEdge& golden, const EventEdge& actual) {
    if (golden.tick == actual.tick) return;
    const auto off = std::abs(golden.tick - actual.tick);
    tell(golden.tick < actual.tick ? golden : actual, golden.tick, actual.tick, off > allowed_,
         static_cast<double>(off),
         fmt::format("{} {} at tick {}, expected tick {}", sequence_.source.what, verb_of(golden), actual.tick,
                     golden.tick));
    if (blanks_ && off <= allowed_) blank(golden.time, actual.time);
  }

  void judge_short(const EventEdge& begin, const EventEdge& end, bool missing) {
    const auto lasts = end.tick - begin.tick;
    const std::string text = fmt::format("{} {} at tick {} for {} tick{}, which {}", sequence_.source.what,
                                         verb_of(begin), begin.tick, lasts, lasts == 1 ? "" : "s", lacks(missing));
    for (const EventEdge* edge : {&begin, &end}) tell_lone(*edge, missing, false, static_cast<double>(lasts), text);
    if (blanks_) blank(begin.time, end.time);
  }

  void judge_lone(const EventEdge& edge, bool missing) {
    // its partner may come after the end of the compared time
    const bool at_end = last_tick() - edge.tick < allowed_;
    tell_lone(
        edge, missing, !at_end, never,
        fmt::format("{} {} at tick {}, which {}", sequence_.source.what, verb_of(edge), edge.tick, lacks(missing)));
  }

  static const char* lacks(bool missing) {
    return missing ? "is missing in this run" : "is extra: the golden hasn't it";
  }

  std::int64_t last_tick() const {
    const std::int64_t golden = traces_.clock.tick_at(traces_.end), actual = traces_.actual_clock.tick_at(traces_.end);
    return std::min(golden, actual);
  }

  void tell_lone(const EventEdge& edge, bool missing, bool beyond, double off, std::string note) {
    const auto here = std::optional(edge.tick);
    tell(edge, missing ? here : std::nullopt, missing ? std::nullopt : here, beyond, off, std::move(note));
  }

  void tell(const EventEdge& edge, std::optional<std::int64_t> expected, std::optional<std::int64_t> actual,
            bool beyond, double off, std::string note) {
    const EventSource& source = sequence_.source;
    if (differences_.size() < most_differences)
      differences_.push_back({name_, std::string(verb_of(edge)), expected, actual, beyond});
    const double allowed = off == never ? 0.0 : allowed_;
    if (!findings_.count(off, allowed, beyond)) return;
    Divergence divergence;
    divergence.tick = edge.tick;
    divergence.time = static_cast<double>(edge.time) / 1e9;
    divergence.channel = source.channel;
    divergence.element = source.element;
    divergence.stage = stage_of(source.channel);
    divergence.difference = off;
    divergence.tolerance = allowed;
    divergence.unit = "ticks";
    divergence.note = std::move(note);
    findings_.describe(divergence, beyond);
  }

  void blank(std::uint64_t a, std::uint64_t b) {
    for (const std::string& body : sequence_.source.bodies)
      traces_.blanked[body].push_back({std::min(a, b), std::max(a, b)});
  }

  ComparedTraces& traces_;
  const std::string& name_;
  const EventSequence& sequence_;
  ChannelFindings& findings_;
  std::vector<EventDifference>& differences_;
  int allowed_ = 0;  // [ticks]
  bool blanks_ = false;
};

std::string text_of(const msg::Event& event) {
  return fmt::format("tick {}, {}, {}: {}", event.tick, event.severity, event.source, event.text);
}

bool say_the_same(const msg::Event& a, const msg::Event& b) {
  return a.severity == b.severity && a.source == b.source && a.text == b.text;
}

/// True for a controller's own line that no rule compares.
bool is_mere_word(const msg::Event& event, const std::vector<ToleranceRule>& rules) {
  return event.severity == to_string(Severity::note) && std::ranges::none_of(rules, [&](const ToleranceRule& rule) {
           return rule.channel.starts_with("events/") && matches(rule.channel, "events/" + event.source);
         });
}

/// Compares the messages of one kind in their order, and reports the first that differs from the golden's.
class MessageJudge {
 public:
  enum class Kind { judged, words };  // a difference of words fails nothing

  MessageJudge(const ComparedTraces& traces, Kind kind, ChannelFindings& findings,
               std::vector<EventDifference>& differences)
      : traces_(traces), kind_(kind), findings_(findings), differences_(differences) {}

  void judge() {
    const std::vector<msg::Event> golden = of_kind(traces_.golden), actual = of_kind(traces_.actual);
    std::size_t i = 0;
    for (; i < std::min(golden.size(), actual.size()); ++i) {
      if (std::max(golden[i].stamp.to_ns(), actual[i].stamp.to_ns()) > traces_.end) break;
      if (!say_the_same(golden[i], actual[i])) break;
      if (golden[i].tick != actual[i].tick && !is_near(golden[i], actual[i])) break;
    }
    findings_.result().values += static_cast<std::int64_t>(i);
    const bool expected = i < golden.size() && golden[i].stamp.to_ns() <= traces_.end;
    const bool there = i < actual.size() && actual[i].stamp.to_ns() <= traces_.end;
    if (!expected && !there) return;  // neither run has a further message
    const msg::Event& event = there && (!expected || actual[i].tick <= golden[i].tick) ? actual[i] : golden[i];
    const bool both_say_it = i < golden.size() && i < actual.size() && say_the_same(golden[i], actual[i]);
    if (both_say_it && there != expected && is_near(golden[i], actual[i])) return;  // one comes after the end
    ++findings_.result().values;
    ++findings_.result().differing;
    Divergence divergence = place_of_event(event);
    divergence.note = fmt::format("{} {} is {}, expected {}{}", kind_ == Kind::words ? "line" : "event", i + 1,
                                  there ? "\"" + text_of(actual[i]) + "\"" : "missing",
                                  expected ? "\"" + text_of(golden[i]) + "\"" : "none", reason(golden, actual, i));
    if (kind_ == Kind::words) return findings_.mark(divergence);
    findings_.structure(divergence);
    ++findings_.result().beyond;
    if (differences_.size() < most_differences)
      differences_.push_back({"events/" + event.source, "message",
                              expected ? std::optional(golden[i].tick) : std::nullopt,
                              there ? std::optional(actual[i].tick) : std::nullopt, true});
  }

 private:
  std::vector<msg::Event> of_kind(const Trace& trace) const {
    std::vector<msg::Event> events;
    for (const msg::Event& event : trace.events())
      if (is_mere_word(event, traces_.rules) == (kind_ == Kind::words)) events.push_back(event);
    return events;
  }

  /// True if both are within a rule's tolerance in time. Counts them as differing.
  bool is_near(const msg::Event& golden, const msg::Event& actual) {
    const int allowed = tolerance_of("events/" + golden.source, "", traces_.rules).ticks.value_or(0);
    if (std::abs(golden.tick - actual.tick) > allowed) return false;
    ++findings_.result().differing;
    Divergence divergence = place_of_event(golden.tick < actual.tick ? golden : actual);
    divergence.note = fmt::format("\"{}\" comes at tick {}, expected tick {}", golden.text, actual.tick, golden.tick);
    findings_.mark(divergence);
    return true;
  }

  Divergence place_of_event(const msg::Event& event) {
    Divergence divergence;
    divergence.tick = event.tick;
    divergence.time = static_cast<double>(event.stamp.to_ns()) / 1e9;
    divergence.channel = findings_.result().channel;
    divergence.stage = Stage::controller;
    return divergence;
  }

  /// The reason of a difference, if one of the two messages comes later in the other run; else empty.
  static std::string reason(const std::vector<msg::Event>& golden, const std::vector<msg::Event>& actual,
                            std::size_t i) {
    if (i >= golden.size() || i >= actual.size() || say_the_same(golden[i], actual[i])) return "";
    const auto comes_in = [i](const std::vector<msg::Event>& events, const msg::Event& event) {
      return std::any_of(events.begin() + static_cast<std::ptrdiff_t>(i), events.end(),
                         [&](const msg::Event& other) { return say_the_same(event, other); });
    };
    const bool golden_later = comes_in(actual, golden[i]), actual_later = comes_in(golden, actual[i]);
    if (golden_later && actual_later) return ": the order is different";
    if (golden_later) return ": it is extra";
    return actual_later ? ": the expected one is missing" : "";
  }

  const ComparedTraces& traces_;
  const Kind kind_;
  ChannelFindings& findings_;
  std::vector<EventDifference>& differences_;
};

}  // namespace

void compare_events(ComparedTraces& traces, const AddChannel& add, std::vector<EventDifference>& differences) {
  if (traces.options.takes(stage_of(run_topics::events))) {
    ChannelFindings findings(add(run_topics::events));
    for (const auto kind : {MessageJudge::Kind::judged, MessageJudge::Kind::words})
      MessageJudge(traces, kind, findings, differences).judge();
  }
  const EventSequences sequences = event_sequences(traces.golden_run, traces.actual_run, traces.end);
  std::map<std::string, std::vector<const EventSequences::value_type*>> by_channel;
  for (const auto& sequence : sequences)
    if (traces.options.takes(stage_of(sequence.second.source.channel)))
      by_channel[sequence.second.source.channel].push_back(&sequence);
  for (const auto& [channel, of_channel] : by_channel) {
    ChannelFindings findings(add(channel));
    for (const auto* sequence : of_channel)
      SequenceJudge(traces, sequence->first, sequence->second, findings, differences).judge();
  }
  for (auto& [body, spans] : traces.blanked)
    std::sort(spans.begin(), spans.end(), [](const BlankedSpan& a, const BlankedSpan& b) { return a.from < b.from; });
  std::stable_sort(differences.begin(), differences.end(), [](const EventDifference& a, const EventDifference& b) {
    return a.expected.value_or(a.actual.value_or(0)) < b.expected.value_or(b.actual.value_or(0));
  });
}

}  // namespace rehearse
