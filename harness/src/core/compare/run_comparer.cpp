#include "run_comparer.h"

#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "compare_provenance.h"
#include "compare_structure.h"
#include "conclusion.h"
#include "core/kinds/channel_name.h"
#include "core/trace/run_facts.h"
#include "series_rules.h"

namespace rehearse {

namespace {

/// The number of ticks that both runs have. The message that closes a run contains the state after the last tick, and
/// is no tick itself.
std::int64_t compared_ticks(const ComparedTraces& traces) {
  std::int64_t messages = 0;
  for (std::size_t i = 0; i < traces.clock.size(); ++i) {
    const std::uint64_t time = traces.clock.time(i);
    if (time <= traces.end && traces.actual_clock.has(time)) ++messages;
  }
  std::int64_t recorded = messages;
  if (const auto outcome = RunFacts::of(traces.golden).outcome) recorded = outcome->ticks.value_or(messages);
  return std::min(messages, recorded);
}

/// True if a compared stage makes some of the channel's values. Checkpoints are compared by the state's hash; a
/// comparison of some stages leaves them out.
bool takes(const CompareOptions& options, const TraceChannel& channel) {
  if (channel.type == msg::Tick::type_name) return true;  // decided for each element
  if (channel.type == msg::Checkpoint::type_name) return options.stages.empty();
  return options.takes(stage_of(channel.topic));
}

}  // namespace

ChannelComparison& RunComparer::add_to(std::vector<ChannelComparison>& results, const std::string& topic) {
  ChannelComparison& result = results.emplace_back();
  result.channel = topic;
  result.stage = stage_of(topic);
  return result;
}

RunComparer::RunComparer(const RunSurvey& golden, const RunSurvey& actual, const std::vector<ToleranceRule>& rules,
                         const CompareOptions& options)
    : traces_{golden, actual, rules, options} {
  if (options.until) traces_.end = static_cast<std::uint64_t>(std::llround(std::max(0.0, *options.until) * 1e9));
  const auto taken = [&](const TraceChannel& channel) {
    return takes(options, channel) && !isnt_compared(channel, rules);
  };
  const auto add = [&](const std::string& topic) -> ChannelComparison& { return add_to(results_, topic); };
  if (!traces_.clock.empty() && !traces_.actual_clock.empty()) compare_ticks(traces_, add(run_topics::tick));
  compare_events(
      traces_,
      [&](const std::string& topic) -> ChannelComparison& {
        ChannelComparison& result = add_to(of_events_, topic);
        result.of_events = true;
        return result;
      },
      comparison_.event_differences);
  comparison_.other_inputs = find_other_inputs(traces_);
  if (!comparison_.other_inputs.empty()) comparison_.remarks.push_back(other_inputs_sentence(comparison_.other_inputs));
  find_undecoded(taken);
  compare_lone_channels(traces_, taken, add, comparison_.not_compared);
  comparison_.remarks.insert(comparison_.remarks.end(), comparison_.not_compared.begin(),
                             comparison_.not_compared.end());
  for (const TraceChannel& channel : traces_.golden.channels()) {
    const TraceChannel* other = counterpart(traces_.golden, channel, traces_.actual);
    if (!taken(channel) || !other) continue;
    const bool differing_events = std::ranges::any_of(of_events_, [&](const ChannelComparison& events) {
      return events.channel == channel.topic && events.first_bit;
    });
    comparers_.emplace_back(traces_, PairedChannel{channel, *other, golden.of(channel), actual.of(*other)},
                            differing_events);
  }
  variables_.emplace(traces_);
}

/// Names the channels with messages that can't be decoded.
void RunComparer::find_undecoded(const std::function<bool(const TraceChannel&)>& taken) {
  for (const RunSurvey* run : {&traces_.golden_run, &traces_.actual_run}) {
    for (const TraceChannel& channel : run->whole().channels()) {
      const ChannelSurvey& survey = run->of(channel);
      if (survey.undecoded == 0 || !taken(channel)) continue;
      const bool one = survey.undecoded == 1;
      comparison_.undecoded.push_back(
          fmt::format("{}: {} message{} of the {} can't be decoded, {}at {:.16g} s ({}); {}", channel.topic,
                      survey.undecoded, one ? "" : "s", run == &traces_.golden_run ? "golden" : "run",
                      one ? "" : "the first ", static_cast<double>(survey.first_undecoded) / 1e9, survey.problem,
                      one ? "it is compared by its bytes" : "they are compared by their bytes"));
    }
  }
  comparison_.remarks.insert(comparison_.remarks.end(), comparison_.undecoded.begin(), comparison_.undecoded.end());
}

std::vector<PairedChannel> RunComparer::channels() const {
  std::vector<PairedChannel> channels = variables_->channels();
  for (const ChannelComparer& comparer : comparers_)
    if (comparer.needs_windows()) channels.push_back(comparer.channel());
  return channels;
}

void RunComparer::skip_to(std::uint64_t second) {
  for (ChannelComparer& comparer : comparers_)
    if (comparer.needs_windows()) comparer.take_equal(comparer.channel().golden_survey.messages_before(second));
}

void RunComparer::take(const Window& window) {
  for (ChannelComparer& comparer : comparers_)
    if (comparer.needs_windows()) comparer.take(window);
  variables_->take(window);
}

Comparison RunComparer::finish() {
  for (ChannelComparer& comparer : comparers_) {
    const TraceChannel& channel = comparer.channel().golden;
    ChannelComparison result = comparer.finish();
    if (is_picture(channel)) comparison_.pictures += result.values;
    const bool by_hash = channel.type == msg::Checkpoint::type_name;  // not compared itself, so not reported as equal
    if (!by_hash || result.first_bit) results_.push_back(std::move(result));
  }
  if (std::string remark = variables_->text(); !remark.empty()) comparison_.remarks.push_back(std::move(remark));
  results_.insert(results_.end(), of_events_.begin(), of_events_.end());
  comparison_.ticks = compared_ticks(traces_);
  conclude(comparison_, std::move(results_));
  compare_provenance(traces_, comparison_);
  const Trace* compared[] = {&traces_.golden, &traces_.actual};
  comparison_.warnings = unmatched_rules(traces_.rules, compared);
  return std::move(comparison_);
}

}  // namespace rehearse
