#include "conclusion.h"

#include <fmt/format.h>
#include <rehearse/mcap.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "core/trace/run_facts.h"
#include "divergence_text.h"

namespace rehearse {

std::string_view to_string(Agreement agreement) {
  switch (agreement) {
    case Agreement::equal: return "equal";
    case Agreement::in_noise: return "in noise";
    case Agreement::within: return "within";
    case Agreement::beyond: return "beyond";
  }
  return "";
}

namespace {

Agreement agreement_of(const Comparison& comparison) {
  if (!comparison.within) return Agreement::beyond;
  if (comparison.equal) return Agreement::equal;
  const bool all_noise = comparison.differing > 0 && comparison.in_noise == comparison.differing;
  return all_noise ? Agreement::in_noise : Agreement::within;
}

}  // namespace

void conclude(Comparison& comparison, std::vector<ChannelComparison> channels) {
  const auto take = [](std::optional<Divergence>& best, const std::optional<Divergence>& other) {
    if (other && (!best || comes_before(*other, *best))) best = other;
  };
  std::optional<Divergence> lone;  // the first channel that only one run has
  std::set<std::string> differing;
  for (ChannelComparison& channel : channels) {
    comparison.values += channel.values;
    if (channel.of_events) comparison.events += channel.values;
    comparison.differing += channel.differing;
    comparison.in_noise += channel.in_noise;
    comparison.beyond += channel.beyond;
    comparison.blanked += channel.blanked;
    take(channel.is_lone ? lone : comparison.first, channel.first);
    if (!channel.is_lone) take(comparison.first_bit, channel.first_bit);
    if (channel.worst && (!comparison.worst || is_worse(*channel.worst, *comparison.worst)))
      comparison.worst = channel.worst;
    if (channel.first_bit) differing.insert(channel.channel);
  }
  for (const ChannelComparison& channel : channels)
    if (!channel.of_events && differing.insert(channel.channel).second)
      comparison.equal_channels.push_back(channel.channel);
  if (comparison.first && lone)
    for (const ChannelComparison& channel : channels)
      if (channel.is_lone)
        comparison.remarks.push_back(
            fmt::format("{}: {}", channel.group.empty() ? channel.channel : channel.group, channel.first->note));
  for (ChannelComparison& channel : channels)
    (channel.first_bit ? comparison.channels : comparison.same).push_back(std::move(channel));
  if (!comparison.first) comparison.first = lone;
  if (!comparison.first_bit) comparison.first_bit = lone;
  comparison.equal = !comparison.first_bit;
  comparison.within = !comparison.first;
  comparison.words_alone = comparison.within && !comparison.equal &&
                           std::ranges::all_of(comparison.channels, [](const ChannelComparison& channel) {
                             return channel.channel == run_topics::events;
                           });
  comparison.agreement = agreement_of(comparison);
  std::ranges::stable_sort(comparison.channels, [](const ChannelComparison& a, const ChannelComparison& b) {
    return a.is_lone != b.is_lone ? b.is_lone : comes_before(*a.first_bit, *b.first_bit);
  });
}

Comparison refusal(const Diagnostic& reason) {
  Comparison comparison;
  comparison.agreement = Agreement::beyond;
  Divergence& first = comparison.first.emplace();
  first.stage = Stage::inputs;
  first.note = fmt::format("{}: {}; {}", reason.file, reason.message, reason.hint);
  comparison.first_bit = comparison.first;
  return comparison;
}

}  // namespace rehearse
