#include "state_samples.h"

#include <algorithm>

#include "base/glob.h"
#include "core/kinds/channel_name.h"
#include "core/scenario/trace_scenario.h"
#include "core/trace/filter.h"
#include "core/trace/run_facts.h"

namespace rehearse {
namespace {

bool needs_all_ticks(const Scenario& scenario, const TraceColumn& column) {
  return std::ranges::any_of(scenario.expectations,
                             [&](const Expectation& e) {
                               const auto names_it = [&](const std::string& name) {
                                 return matches(name, column.series);
                               };
                               return matches(e.pattern, column.series) || std::ranges::any_of(e.names, names_it);
                             }) ||
         std::ranges::any_of(scenario.tolerances, [&](const ToleranceRule& rule) {
           return (rule.lead || rule.lag) && matches(rule.channel, column.series);
         });
}

/// A recording of an earlier version doesn't state the devices that controllers read: then any device may be read.
bool may_be_read(const RunFacts& facts, const ChannelName& name) {
  const bool is_of_device = !name.owner.empty() && !name.is_of_link();
  return is_of_device && (!facts.devices_read || facts.devices_read->contains(name.body + "/" + name.owner));
}

}  // namespace

std::optional<StateRate> state_rate_of(const Scenario& scenario, const Trace& run) {
  if (!scenario.golden_state_rate) return std::nullopt;
  StateRate rate{*scenario.golden_state_rate, scenario.time_step, {}};
  const RunFacts facts = RunFacts::of(run);
  for (const TraceChannel& channel : run.channels()) {
    if (!is_state(channel.topic)) continue;
    if (may_be_read(facts, ChannelName::parse(channel.topic)) ||
        std::ranges::any_of(channel.columns, [&](const auto& column) { return needs_all_ticks(scenario, column); }))
      rate.whole.insert(channel.topic);
  }
  return rate;
}

Result<std::filesystem::path> with_state_samples(const std::filesystem::path& recording,
                                                 const std::filesystem::path& scratch) {
  const auto outline = REHEARSE_TRY(Trace::outline(recording));
  const RunFacts facts = RunFacts::of(outline);
  if (facts.state_rate || facts.is_of_log || !outline.find_attachment("scenario.yaml")) return recording;
  const auto scenario = recorded_scenario(outline);
  if (!scenario || !scenario->golden_state_rate) return recording;
  const auto whole = REHEARSE_TRY(Trace::load_in_pieces(recording, [](const Trace&) {}));
  mcap::FilterOptions options;
  options.samples = state_rate_of(*scenario, whole);
  REHEARSE_TRY(mcap::filter(recording, scratch, options));
  return scratch;
}

}  // namespace rehearse
