#include "report_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "core/compare/divergence_text.h"
#include "core/compare/report_json.h"
#include "core/compare/series_rules.h"
#include "core/kinds/channel_name.h"

namespace rehearse {
namespace {

/// The name of the series of a divergence; null: it has none.
ReportJson series_at(const Divergence& divergence, const Trace& golden, const Trace* actual) {
  for (const Trace* trace : {actual, &golden}) {
    const TraceChannel* channel = trace ? trace->find_channel(divergence.channel) : nullptr;
    if (!channel) continue;
    const std::size_t column = column_of(*channel, divergence.element);
    if (column < channel->columns.size()) return channel->columns[column].series;
  }
  return nullptr;
}

using Bound = std::optional<double>;

std::string_view name_of(Expectation::Subject subject) {
  constexpr std::array names{"series", "event", "no_event", "expression"};
  return names[static_cast<std::size_t>(subject)];
}

/// The interval of the series' valid values; without bounds if it isn't one interval, or moves with the run.
std::pair<Bound, Bound> bounds_of(const Expectation& expectation) {
  if (expectation.since) return {};
  Bound low = expectation.above, high = expectation.below;
  if (expectation.near) {
    low = *expectation.near - *expectation.within;
    high = *expectation.near + *expectation.within;
  }
  if (!expectation.absolute) return {low, high};
  if (!high || (low && *low > 0.0)) return {};
  return {-*high, high};
}

ReportJson or_null(const Bound& bound) { return bound ? ReportJson(*bound) : ReportJson(); }

ReportJson sample_json(const std::optional<ViolatingSample>& sample) {
  if (!sample) return nullptr;
  return {{"tick", sample->tick}, {"value", sample->value ? number_json(*sample->value) : ReportJson()}};
}

}  // namespace

namespace {

/// The first difference beyond tolerance on the channel that a check names. The check fed the golden's inputs to the
/// controller; in the run that the report shows, the channel may leave its tolerance later, or not at all.
const Divergence* first_of_this_run(const Comparison& comparison, const Divergence& told) {
  const auto channel = std::ranges::find_if(comparison.channels, [&](const ChannelComparison& compared) {
    return compared.channel == told.channel && !compared.of_events && compared.first && compared.first->is_beyond();
  });
  if (channel != comparison.channels.end()) return &*channel->first;
  return told.is_beyond() && comparison.first && comparison.first->is_beyond() ? &*comparison.first : &told;
}

}  // namespace

Places::Places(const Comparison& comparison, const Divergence* told) {
  for (const ChannelComparison& channel : comparison.channels) {
    if (channel.first) all.emplace_back(*channel.first, true);
    if (channel.first_bit && (!channel.first || to_string(*channel.first) != to_string(*channel.first_bit)))
      all.emplace_back(*channel.first_bit, false);
  }
  const bool is_command = told && told->note.empty() && ChannelName::parse(told->channel).side == ChannelSide::output;
  const Divergence* wanted = is_command ? first_of_this_run(comparison, *told) : told;
  if (!wanted && comparison.first) wanted = &*comparison.first;
  if (!wanted && comparison.first_bit) wanted = &*comparison.first_bit;
  if (!wanted) return;
  const std::string text = to_string(*wanted);
  if (std::ranges::none_of(all, [&](const auto& place) { return to_string(place.first) == text; }))
    all.emplace_back(*wanted, wanted->is_beyond());
  std::ranges::stable_sort(all, [](const auto& a, const auto& b) { return comes_before(a.first, b.first); });
  for (std::size_t i = 0; i < all.size() && !first; ++i)
    if (to_string(all[i].first) == text) first = i;
}

ReportJson places_json(const Places& places, const Trace& golden, const Trace& actual) {
  ReportJson list = ReportJson::array();
  for (const auto& [divergence, beyond] : places.all) {
    ReportJson place = json_of(std::optional<Divergence>(divergence));
    place["series"] = series_at(divergence, golden, &actual);
    place["beyond"] = beyond;
    list.push_back(std::move(place));
  }
  return list;
}

ReportJson worst_json(const Comparison& comparison, const Trace& golden, const Trace& actual) {
  std::vector<const Divergence*> worst;
  for (const ChannelComparison& channel : comparison.channels)
    if (channel.beyond > 0 && channel.worst) worst.push_back(&*channel.worst);
  const auto multiple = [](const Divergence& place) {
    return place.tolerance > 0.0 ? place.judged() / place.tolerance : std::numeric_limits<double>::max();
  };
  std::ranges::stable_sort(worst,
                           [&](const Divergence* a, const Divergence* b) { return multiple(*a) > multiple(*b); });
  ReportJson list = ReportJson::array();
  for (const Divergence* place : worst)
    if (ReportJson series = series_at(*place, golden, &actual); !series.is_null()) list.push_back(std::move(series));
  return list;
}

ReportJson expectations_json(const std::vector<ExpectationResult>& results, double time_step, std::int64_t begin,
                             std::int64_t last) {
  const auto tick_of = [&](const std::optional<double>& time, std::int64_t otherwise) {
    const double tick = time ? std::round(*time / time_step) : static_cast<double>(otherwise);
    return static_cast<std::int64_t>(std::clamp(tick, static_cast<double>(begin), static_cast<double>(last)));
  };
  ReportJson list = ReportJson::array();
  for (const ExpectationResult& result : results) {
    const Expectation& expectation = result.expectation;
    const auto [low, high] = bounds_of(expectation);
    const std::int64_t from =
        expectation.at_end ? last : tick_of(expectation.at ? expectation.at : expectation.from, begin);
    const std::int64_t until = tick_of(expectation.at ? expectation.at : expectation.until, last);
    list.push_back({{"text", result.text},
                    {"holds", result.holds},
                    {"sentence", result.sentence},
                    {"closest", closest_text(result)},
                    {"line", expectation.place.line},
                    {"subject", name_of(expectation.subject)},
                    {"pattern", expectation.pattern},
                    {"series", result.series.empty() ? ReportJson() : ReportJson(result.series)},
                    {"low", or_null(low)},
                    {"high", or_null(high)},
                    {"margin", or_null(result.margin)},
                    {"begin", from},
                    {"end", until},
                    {"sometime", expectation.sometime},
                    {"first", sample_json(result.first)},
                    {"worst", sample_json(result.worst)}});
  }
  return list;
}

}  // namespace rehearse
