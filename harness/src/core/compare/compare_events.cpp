// Comparison of events: contacts, limits and refusals as sequences that begin and end, messages as text.
#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/glob.h"
#include "channel_findings.h"
#include "compare_structure.h"
#include "core/kinds/channel_name.h"
#include "core/kinds/cost_fields.h"
#include "core/trace/event_stream.h"
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

enum class MessageKind { judged, words };  // a difference of words fails nothing

/// The messages of one kind of a run, in their order. That costs aren't counted is none: it follows from the process.
class MessageSequence {
 public:
  MessageSequence(const Trace& trace, MessageKind kind, const std::vector<ToleranceRule>& rules)
      : stream_(trace), kind_(kind), rules_(rules) {
    advance();
  }

  /// The present message; null after the last.
  const msg::Event* now() const { return now_; }
  bool is_until(std::uint64_t end) const { return now_ && now_->stamp.to_ns() <= end; }
  void advance() {
    do {
      now_ = stream_.next();
    } while (now_ &&
             (now_->source == uncounted_costs_source || is_mere_word(*now_, rules_) != (kind_ == MessageKind::words)));
  }
  /// True if the present message or one after it says the same.
  bool comes_to(const msg::Event& event) {
    while (now_ && !say_the_same(event, *now_)) advance();
    return now_ != nullptr;
  }

 private:
  EventStream stream_;
  const MessageKind kind_;
  const std::vector<ToleranceRule>& rules_;
  const msg::Event* now_ = nullptr;
};

/// Compares the messages of one kind in their order, and reports the first that differs from the golden's.
class MessageJudge {
 public:
  MessageJudge(const ComparedTraces& traces, MessageKind kind, ChannelFindings& findings,
               std::vector<EventDifference>& differences)
      : traces_(traces),
        kind_(kind),
        golden_(traces.golden, kind, traces.rules),
        actual_(traces.actual, kind, traces.rules),
        findings_(findings),
        differences_(differences) {}

  void judge() {
    std::int64_t number = 1;
    for (; golden_.is_until(traces_.end) && actual_.is_until(traces_.end); ++number) {
      const msg::Event &golden = *golden_.now(), &actual = *actual_.now();
      if (!say_the_same(golden, actual)) break;
      if (golden.tick != actual.tick && !is_near(golden, actual)) break;
      golden_.advance();
      actual_.advance();
    }
    findings_.result().values += number - 1;
    const bool expected = golden_.is_until(traces_.end), there = actual_.is_until(traces_.end);
    if (!expected && !there) return;  // neither run has a further message
    const bool both_say_it = golden_.now() && actual_.now() && say_the_same(*golden_.now(), *actual_.now());
    if (both_say_it && there != expected && is_near(*golden_.now(), *actual_.now())) return;  // one comes after the end
    report(number, expected ? golden_.now() : nullptr, there ? actual_.now() : nullptr);
  }

 private:
  /// Reports the present messages as different; null: that run has none. Reads on in both runs.
  void report(std::int64_t number, const msg::Event* golden, const msg::Event* actual) {
    const msg::Event& event = actual && (!golden || actual->tick <= golden->tick) ? *actual : *golden;
    ++findings_.result().values;
    ++findings_.result().differing;
    Divergence divergence = place_of_event(event);
    const auto tick_of = [](const msg::Event* one) { return one ? std::optional(one->tick) : std::nullopt; };
    EventDifference difference{"events/" + event.source, "message", tick_of(golden), tick_of(actual), true};
    const auto quoted = [](const msg::Event* one, const char* none) {
      return one ? "\"" + text_of(*one) + "\"" : none;
    };
    divergence.note = fmt::format("{} {} is {}, expected {}", kind_ == MessageKind::words ? "line" : "event", number,
                                  quoted(actual, "missing"), quoted(golden, "none"));
    divergence.note += reason();
    if (kind_ == MessageKind::words) return findings_.mark(divergence);
    findings_.structure(divergence);
    ++findings_.result().beyond;
    if (differences_.size() < most_differences) differences_.push_back(std::move(difference));
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

  /// The reason of the difference of the present messages, if one of the two comes later in the other run; else empty.
  /// Reads on in both runs.
  std::string reason() {
    if (!golden_.now() || !actual_.now() || say_the_same(*golden_.now(), *actual_.now())) return "";
    const msg::Event golden = *golden_.now(), actual = *actual_.now();
    const bool golden_later = actual_.comes_to(golden), actual_later = golden_.comes_to(actual);
    if (golden_later && actual_later) return ": the order is different";
    if (golden_later) return ": it is extra";
    return actual_later ? ": the expected one is missing" : "";
  }

  const ComparedTraces& traces_;
  const MessageKind kind_;
  MessageSequence golden_, actual_;
  ChannelFindings& findings_;
  std::vector<EventDifference>& differences_;
};

/// Compares the messages of controllers and harness. Runs with equal bytes on these channels aren't read again.
void compare_messages(const ComparedTraces& traces, ChannelFindings& findings,
                      std::vector<EventDifference>& differences) {
  std::uint64_t messages = 0;
  bool are_equal = true;
  for (const TraceChannel& channel : traces.golden.channels()) {
    if (channel.type != msg::Event::type_name) continue;
    const TraceChannel* other = counterpart(traces.golden, channel, traces.actual);
    const ChannelSurvey& survey = traces.golden_run.of(channel);
    are_equal = are_equal && other && survey == traces.actual_run.of(*other) && survey.undecoded == 0 &&
                (survey.messages == 0 || survey.last_time <= traces.end);
    messages += survey.messages;
  }
  for (const TraceChannel& channel : traces.actual.channels())
    if (channel.type == msg::Event::type_name)
      are_equal = are_equal && counterpart(traces.actual, channel, traces.golden);
  if (are_equal) {
    findings.result().values += static_cast<std::int64_t>(messages);
    return;
  }
  for (const auto kind : {MessageKind::judged, MessageKind::words})
    MessageJudge(traces, kind, findings, differences).judge();
}

}  // namespace

void compare_events(ComparedTraces& traces, const AddChannel& add, std::vector<EventDifference>& differences) {
  if (traces.options.takes(stage_of(run_topics::events))) {
    ChannelFindings findings(add(run_topics::events));
    compare_messages(traces, findings, differences);
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
    std::ranges::sort(spans, [](const BlankedSpan& a, const BlankedSpan& b) { return a.from < b.from; });
  std::ranges::stable_sort(differences, [](const EventDifference& a, const EventDifference& b) {
    return a.expected.value_or(a.actual.value_or(0)) < b.expected.value_or(b.actual.value_or(0));
  });
}

}  // namespace rehearse
