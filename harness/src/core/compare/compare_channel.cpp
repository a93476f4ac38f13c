#include "compare_channel.h"

#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "compare_fields.h"
#include "core/kinds/channel_name.h"

namespace rehearse {

std::pair<std::size_t, std::size_t> Window::messages(const TraceChannel& channel) const {
  const auto& times = channel.times;
  const auto first = std::ranges::lower_bound(times, begin);
  const auto behind = std::upper_bound(first, times.end(), end);
  return {static_cast<std::size_t>(first - times.begin()), static_cast<std::size_t>(behind - times.begin())};
}

const TraceChannel& table_in(const Trace& window, const Trace& whole, const TraceChannel& channel) {
  return window.channels()[static_cast<std::size_t>(&channel - whole.channels().data())];
}

namespace {

MatchedChannel match(const ComparedTraces& traces, const Window& window, const TraceChannel& golden,
                     const TraceChannel& actual) {
  MatchedChannel matched{window, golden, actual};
  auto [g, golden_end] = window.messages(golden);
  auto [a, actual_end] = window.messages(actual);
  while (g < golden_end || a < actual_end) {
    const std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
    const std::uint64_t expected = g < golden_end ? golden.times[g] : never;
    const std::uint64_t seen = a < actual_end ? actual.times[a] : never;
    if (expected == seen) {
      const bool decoded = !golden.problem_of(g) && !actual.problem_of(a);
      (decoded ? matched.pairs : matched.undecoded).emplace_back(g++, a++);
      continue;
    }
    const bool lacking = expected < seen;
    std::vector<std::size_t>& lone = lacking ? matched.missing : matched.extra;
    if (!traces.in_a_lone_tick(std::min(expected, seen))) lone.push_back(lacking ? g : a);
    ++(lacking ? g : a);
  }
  return matched;
}

/// True for channels whose values are compared elsewhere: checkpoints by the state's hash, events as sequences.
bool is_compared_elsewhere(const TraceChannel& channel) {
  return channel.type == msg::Checkpoint::type_name || channel.type == msg::Event::type_name ||
         channel.type == msg::ContactChange::type_name;
}

/// True if both report one contact with its links in reverse order: the scenario lists its bodies in a different order.
bool is_contact_reversed(const msg::ContactChange& a, const msg::ContactChange& b) {
  return a.stamp.to_ns() == b.stamp.to_ns() && a.tick == b.tick && a.begins == b.begins && a.link == b.other &&
         a.other == b.link;
}

/// Compares the fields of events whose sequences are equal but whose bytes differ.
class EventFieldJudge final : public PartJudge {
 public:
  EventFieldJudge(const ComparedTraces& traces, const PairedChannel& channel, ChannelFindings& findings)
      : traces_(traces), findings_(findings), fields_(traces, channel, findings) {}

  void take(const MatchedChannel& channel) override {
    fields_.begin(channel);
    for (const auto& [golden, actual] : channel.pairs) {
      if (channel.golden.hashes[golden] == channel.actual.hashes[actual]) continue;
      if (channel.golden.type == msg::ContactChange::type_name &&
          is_contact_reversed(traces_.golden.contact_changes()[channel.golden.earlier + golden],
                              traces_.actual.contact_changes()[channel.actual.earlier + actual])) {
        Divergence divergence = place_of(traces_, channel.golden, channel.golden.times[golden]);
        divergence.note = "the two links are in reverse order";
        findings_.mark(divergence);
        continue;
      }
      const auto expected = channel.window.golden.payload(channel.golden, golden);
      const auto other = channel.window.actual.payload(channel.actual, actual);
      if (expected && other && !fields_.compare(golden, *expected, *other)) fields_.report_encoding(golden);
    }
  }

 private:
  const ComparedTraces& traces_;
  ChannelFindings& findings_;
  FieldJudge fields_;
};

}  // namespace

ChannelComparer::ChannelComparer(const ComparedTraces& traces, const PairedChannel& channel, bool differing_events)
    : traces_(traces), channel_(channel), differing_events_(differing_events) {
  result_.channel = channel.golden.topic;
  result_.stage = stage_of(channel.golden.topic);
  if (has_another_form()) return;
  const ChannelSurvey& survey = channel.golden_survey;
  needs_windows_ = !channel.is_equal() || survey.last_time > traces.end;
  if (!needs_windows_) take_equal(survey.messages);
}

void ChannelComparer::take_equal(std::uint64_t messages) {
  if (messages == 0) return;
  make_judges();
  for (const auto& judge : judges_) judge->take_equal(static_cast<std::int64_t>(messages));
}

bool ChannelComparer::has_another_form() {
  const auto& [golden, actual, golden_survey, actual_survey] = channel_;
  const bool both_spoke = golden_survey.messages > 0 && actual_survey.messages > 0;
  if (golden.type == actual.type && (!both_spoke || golden.columns.empty() == actual.columns.empty())) return false;
  Divergence divergence = place_of(traces_, golden, golden_survey.messages > 0 ? golden_survey.first_time : 0);
  divergence.note = golden.type == actual.type ? "only one of the traces has numbers here"
                                               : fmt::format("is of type {}, expected {}", actual.type, golden.type);
  findings_.structure(divergence);
  return true;
}

void ChannelComparer::make_judges() {
  if (std::exchange(has_judges_, true)) return;
  if (channel_.golden.type == msg::Checkpoint::type_name) return;
  if (is_compared_elsewhere(channel_.golden)) {
    const bool in_step = channel_.golden_survey.times_hash == channel_.actual_survey.times_hash;
    if (!differing_events_ && in_step)
      judges_.push_back(std::make_unique<EventFieldJudge>(traces_, channel_, findings_));
  } else if (channel_.golden.columns.empty()) {
    judges_.push_back(judge_payloads(traces_, channel_, findings_));
  } else {
    judges_.push_back(judge_numbers(traces_, channel_, findings_));
    judges_.push_back(judge_rests(traces_, channel_, findings_));
  }
}

void ChannelComparer::Lone::take(const ComparedTraces& traces, const TraceChannel& of,
                                 const std::vector<std::size_t>& messages) {
  if (messages.empty()) return;
  count += std::ssize(messages);
  if (!first) first = place_of(traces, of, of.times[messages.front()]);
}

void ChannelComparer::take(const Window& window) {
  const TraceChannel& golden = table_in(window.golden, traces_.golden, channel_.golden);
  const TraceChannel& actual = table_in(window.actual, traces_.actual, channel_.actual);
  const MatchedChannel matched = match(traces_, window, golden, actual);
  missing_.take(traces_, golden, matched.missing);
  extra_.take(traces_, actual, matched.extra);
  compare_bytes(matched);
  if (matched.pairs.empty()) return;
  make_judges();
  for (const auto& judge : judges_) judge->take(matched);
}

/// Compares the messages of which one can't be decoded by their bytes.
void ChannelComparer::compare_bytes(const MatchedChannel& matched) {
  for (const auto& [golden, actual] : matched.undecoded) {
    ++result_.values;
    if (matched.golden.hashes[golden] == matched.actual.hashes[actual]) continue;
    const double infinite = std::numeric_limits<double>::infinity();
    if (!findings_.count(infinite, 0.0, true)) continue;
    const std::string* problem = matched.actual.problem_of(actual);
    Divergence divergence = place_of(traces_, matched.golden, matched.golden.times[golden]);
    divergence.difference = infinite;
    divergence.note = problem
                          ? "its bytes differ; it can't be decoded: " + *problem
                          : "its bytes differ; the golden's can't be decoded: " + *matched.golden.problem_of(golden);
    findings_.describe(divergence, true);
  }
}

void ChannelComparer::report(Lone& lone, const char* what) {
  if (!lone.first) return;
  lone.first->note = lone.count == 1 ? fmt::format("this message is {}", what)
                                     : fmt::format("{} messages are {}; this is the first", lone.count, what);
  findings_.structure_before(*lone.first);
}

ChannelComparison ChannelComparer::finish() {
  for (const auto& judge : judges_) judge->finish();
  const bool of_events = is_compared_elsewhere(channel_.golden) && channel_.golden.type != msg::Checkpoint::type_name;
  if (!of_events) {
    report(extra_, "extra: the golden hasn't that");
    report(missing_, "missing");
    result_.missing = missing_.count;
    result_.extra = extra_.count;
  }
  return std::move(result_);
}

}  // namespace rehearse
