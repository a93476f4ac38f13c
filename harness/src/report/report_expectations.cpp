#include "report_expectations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "compare/report_json.h"

namespace rehearse {
namespace {

using Bound = std::optional<double>;

std::string_view name_of(Expectation::Subject subject) {
  constexpr std::array names{"series", "event", "no_event"};
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
                    {"line", expectation.place.line},
                    {"subject", name_of(expectation.subject)},
                    {"pattern", expectation.pattern},
                    {"series", result.series.empty() ? ReportJson() : ReportJson(result.series)},
                    {"low", or_null(low)},
                    {"high", or_null(high)},
                    {"begin", from},
                    {"end", until},
                    {"sometime", expectation.sometime},
                    {"first", sample_json(result.first)},
                    {"worst", sample_json(result.worst)}});
  }
  return list;
}

}  // namespace rehearse
