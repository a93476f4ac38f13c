// Comparison of events: contacts, limits and refusals as sequences that begin and end, messages as text.
#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cstdlib>

#include "channel_findings.h"
#include "compare_structure.h"
#include "core/kinds/channel_name.h"
#include "core/mcap/glob.h"
#include "event_sequences.h"

namespace rehearse {
namespace {

constexpr std::size_t most_differences = 1000;  // number of listed differences

/// Judges one sequence of events, and blanks the numbers between events that are early or late within a rule's
/// tolerance.
void judge(ComparedTraces& traces, const std::string& name, const EventSequence& sequence, ChannelFindings& findings,
           std::vector<EventDifference>& differences) {
  const auto stated = tolerance_of(name, "", traces.rules).ticks;
  const int allowed = stated.value_or(default_ticks(sequence.source.kind));
  const std::int64_t last_tick = std::min(traces.clock.tick_at(traces.end), traces.actual_clock.tick_at(traces.end));
  const JudgedSequence judged = judge_sequence(sequence, allowed, last_tick);
  findings.result().values += judged.events;
  for (const JudgedEvent& event : judged.differing) {
    if (differences.size() < most_differences)
      differences.push_back({name, std::string(verb_of(event.edge)), event.expected, event.actual, event.beyond});
    if (findings.count(event.place.difference, event.place.tolerance, event.beyond))
      findings.describe(event.place, event.beyond);
  }
  if (!stated || *stated == 0) return;
  for (const auto& [from, until] : judged.apart)
    for (const std::string& body : sequence.source.bodies) traces.blanked[body].push_back({from, until});
}

std::string text_of(const msg::Event& event) {
  return fmt::format("tick {}, {}, {}: {}", event.tick, event.severity, event.source, event.text);
}

bool say_the_same(const msg::Event& a, const msg::Event& b) {
  return a.severity == b.severity && a.source == b.source && a.text == b.text;
}

/// True for a controller's own line, and a remark on the world, which follows from values that are compared; unless a
/// rule compares it.
bool is_mere_word(const msg::Event& event, const std::vector<ToleranceRule>& rules) {
  const bool is_line = event.severity == to_string(Severity::note) || is_of_observations(event);
  return is_line && std::ranges::none_of(rules, [&](const ToleranceRule& rule) {
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
    divergence.stage = is_of_observations(event) ? Stage::physics : Stage::controller;
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
    for (const auto* sequence : of_channel) judge(traces, sequence->first, sequence->second, findings, differences);
  }
  for (auto& [body, spans] : traces.blanked)
    std::sort(spans.begin(), spans.end(), [](const BlankedSpan& a, const BlankedSpan& b) { return a.from < b.from; });
  std::stable_sort(differences.begin(), differences.end(), [](const EventDifference& a, const EventDifference& b) {
    return a.expected.value_or(a.actual.value_or(0)) < b.expected.value_or(b.actual.value_or(0));
  });
}

}  // namespace rehearse
