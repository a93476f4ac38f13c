#include "report_places.h"

#include <algorithm>
#include <limits>

#include "compare/compare_parts.h"
#include "compare/report_json.h"

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

}  // namespace

Places::Places(const Comparison& comparison, const Divergence* told) {
  for (const ChannelComparison& channel : comparison.channels) {
    if (channel.first) all.emplace_back(*channel.first, true);
    if (channel.first_bit && (!channel.first || to_string(*channel.first) != to_string(*channel.first_bit)))
      all.emplace_back(*channel.first_bit, false);
  }
  const Divergence* wanted = told;
  if (!wanted && comparison.first) wanted = &*comparison.first;
  if (!wanted && comparison.first_bit) wanted = &*comparison.first_bit;
  if (!wanted) return;
  const std::string text = to_string(*wanted);
  if (std::none_of(all.begin(), all.end(), [&](const auto& place) { return to_string(place.first) == text; }))
    all.emplace_back(*wanted, true);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return comes_before(a.first, b.first); });
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
    return place.tolerance > 0.0 ? place.difference / place.tolerance : std::numeric_limits<double>::max();
  };
  std::stable_sort(worst.begin(), worst.end(),
                   [&](const Divergence* a, const Divergence* b) { return multiple(*a) > multiple(*b); });
  ReportJson list = ReportJson::array();
  for (const Divergence* place : worst)
    if (ReportJson series = series_at(*place, golden, &actual); !series.is_null()) list.push_back(std::move(series));
  return list;
}

}  // namespace rehearse
