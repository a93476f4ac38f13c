#include <fmt/format.h>
#include <rehearse/check.h>
#include <rehearse/mcap.h>
#include <rehearse/scenario.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "base/clock.h"
#include "base/hashing.h"
#include "core/kinds/channel_name.h"
#include "core/trace/trace_windows.h"
#include "expectation_judge.h"
#include "expectation_text.h"

namespace rehearse {

std::vector<ExpectationResult> judge_expectations(const std::vector<Expectation>& expectations, const Trace& run) {
  ExpectationJudge judge(expectations);
  judge.take(run);
  return judge.finish(run);
}

namespace {

/// Judges a file by its wanted channels; null: by all.
Result<std::vector<ExpectationResult>> judge_file(const std::vector<Expectation>& expectations,
                                                  const std::filesystem::path& recording, std::size_t piece_size,
                                                  Trace::Damage damage,
                                                  const std::function<bool(const mcap::Channel&)>& wanted,
                                                  bool& found_all) {
  std::optional<Trace> names;
  for (;;) {
    ExpectationJudge judge(expectations, names ? &*names : nullptr);
    const auto take = [&judge](const Trace& piece) { judge.take(piece); };
    auto last = REHEARSE_TRY(load_pieces(recording, wanted, take, piece_size,
                                         judge.needs_order() ? PieceOrder::of_time : PieceOrder::of_file, damage));
    std::vector<ExpectationResult> results = judge.finish(last);
    found_all = judge.found_all() && !judge.any_mistake();
    if (!judge.lacked_names() || names) return results;
    names = std::move(last);
  }
}

bool may_concern(const mcap::Channel& channel, const Expectation& expectation) {
  if (expectation.subject == Expectation::Subject::series) return may_match(channel.topic, expectation.pattern);
  if (expectation.subject != Expectation::Subject::expression) return false;
  return channel.topic == run_topics::contact_changes ||
         std::ranges::any_of(expectation.names,
                             [&](const std::string& name) { return may_match(channel.topic, name); });
}

}  // namespace

Result<std::vector<ExpectationResult>> judge_expectations(const std::vector<Expectation>& expectations,
                                                          const std::filesystem::path& recording,
                                                          std::size_t piece_size) {
  return judge_expectations(expectations, recording, Trace::Damage::refuse, piece_size);
}

Result<std::vector<ExpectationResult>> judge_expectations(const std::vector<Expectation>& expectations,
                                                          const std::filesystem::path& recording, Trace::Damage damage,
                                                          std::size_t piece_size) {
  if (expectations.empty()) return std::vector<ExpectationResult>();
  const auto is_judged = [&expectations](const mcap::Channel& channel) {
    return channel.topic == run_topics::tick || channel.topic == run_topics::events ||
           std::ranges::any_of(expectations, [&](const Expectation& e) { return may_concern(channel, e); });
  };
  bool found_all = true;
  auto some = judge_file(expectations, recording, piece_size, damage, is_judged, found_all);
  if (!some || found_all) return some;
  return judge_file(expectations, recording, piece_size, damage, nullptr, found_all);
}

namespace {

/// The hash of the messages of a recording that comes in pieces.
class ContentHash {
 public:
  void take(const Trace& piece) {
    for (const TraceChannel& channel : piece.channels()) {
      RunningHash& hash = by_topic_[channel.topic];
      hash.add(channel.times.data(), channel.times.size() * sizeof(std::uint64_t));
      hash.add(channel.hashes.data(), channel.hashes.size() * sizeof(std::uint64_t));
    }
  }
  std::uint64_t value() const {
    std::uint64_t hash = 0;
    for (const auto& [topic, of_channel] : by_topic_) {
      const std::uint64_t messages = of_channel.value();
      hash = hash_bytes(topic.data(), topic.size(), hash_bytes(&messages, sizeof messages, hash));
    }
    return hash;
  }

 private:
  std::map<std::string, RunningHash> by_topic_;
};

}  // namespace

Result<JudgedRecording> judge_recording(const std::vector<Expectation>& expectations,
                                        const std::filesystem::path& recording) {
  ExpectationJudge judge(expectations);
  ContentHash content;
  const bool judges = !judge.needs_order();
  const auto last = REHEARSE_TRY(Trace::load_in_pieces(recording, [&](const Trace& piece) {
    if (judges) judge.take(piece);
    content.take(piece);
  }));
  if (judges) return JudgedRecording{judge.finish(last), content.value()};
  auto judged = REHEARSE_TRY(judge_expectations(expectations, recording));
  return JudgedRecording{std::move(judged), content.value()};
}

const ExpectationResult* first_violation(const std::vector<ExpectationResult>& results) {
  // only the end of a run shows that something never came
  const auto known_at = [](const ExpectationResult& result) {
    if (result.undecided) return std::pair(true, 0.0);
    const bool is_of_some =
        result.expectation.sometime || result.expectation.quantifier == Expectation::Quantifier::eventually;
    const bool at_once = result.first && !is_of_some;
    return std::pair(false, at_once ? result.first->time : std::numeric_limits<double>::infinity());
  };
  const ExpectationResult* first = nullptr;
  for (const ExpectationResult& result : results)
    if (!result.holds && (!first || known_at(result) < known_at(*first))) first = &result;
  return first;
}

Divergence divergence_of(const ExpectationResult& violation, const Trace& run) {
  Divergence divergence;
  TickClock clock;
  if (const TraceChannel* ticks = run.find_channel(run_topics::tick); ticks && !violation.first)
    for_each_window(run, {static_cast<std::size_t>(ticks - run.channels().data())},
                    [&](const Trace& window) { return clock.take(window), true; });
  const auto place = run.find_series(violation.series);
  if (violation.first) {
    divergence.tick = violation.first->tick;
    divergence.time = violation.first->time;
  } else if (!clock.empty()) {
    divergence.tick = clock.tick_at(clock.last_time());
    divergence.time = seconds_of(clock.last_time());
  }
  if (place) {
    const TraceChannel& channel = run.channels()[place->channel];
    divergence.channel = channel.topic;
    divergence.element = channel.columns[place->column].element;
    divergence.unit = unit_of(channel.metadata, divergence.element);
    divergence.stage = stage_of(divergence.channel, divergence.element);
  } else if (violation.expectation.subject == Expectation::Subject::event ||
             violation.expectation.subject == Expectation::Subject::no_event) {
    divergence.channel = run_topics::events;
    divergence.stage = stage_of(divergence.channel);
  }
  if (violation.first && violation.first->value) divergence.actual = *violation.first->value;
  divergence.note = violation.sentence;
  return divergence;
}

namespace {

/// "; not judged: A/x has no sample", of expectations that hold.
std::string not_judged_text(const std::vector<ExpectationResult>& results) {
  std::vector<std::string> series;
  for (const ExpectationResult& result : results)
    for (const std::string& name : result.not_judged)
      if (std::ranges::find(series, name) == series.end()) series.push_back(name);
  return series.empty() ? "" : "; not judged: " + without_sample_text(series);
}

}  // namespace

std::string verdict(const std::vector<ExpectationResult>& results) {
  if (results.empty()) return {};
  const ExpectationResult* first = first_violation(results);
  if (first == nullptr)
    return (results.size() == 1 ? fmt::format("the expectation holds: {}", results[0].text)
                                : fmt::format("all {} expectations hold", results.size())) +
           not_judged_text(results);
  const auto undecided = std::ranges::count(results, true, &ExpectationResult::undecided);
  const auto violated = std::ranges::count(results, false, &ExpectationResult::holds) - undecided;
  std::string text = first->sentence;
  auto add = [&, is_first = true](std::ptrdiff_t count, std::string_view state) mutable {
    if (count == 0) return;
    text += fmt::format("; {} more{} {} {}", count, is_first ? fmt::format(" of {} expectations", results.size()) : "",
                        count == 1 ? "is" : "are", state);
    is_first = false;
  };
  add(violated - (first->undecided ? 0 : 1), "violated");
  add(undecided - (first->undecided ? 1 : 0), "undecided");
  return text;
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
