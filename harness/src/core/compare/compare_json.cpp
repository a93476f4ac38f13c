// Divergences and comparisons as JSON.
#include <cmath>
#include <limits>

#include "report_json.h"

namespace rehearse {
namespace {

using nlohmann::ordered_json;

template <class T>
ordered_json or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json object_of(const Divergence& d) {
  const bool of_numbers = d.note.empty();
  const auto if_numbers = [of_numbers](double value) { return of_numbers ? number_json(value) : ordered_json(); };
  const bool comparable = of_numbers && d.ulps != std::numeric_limits<std::uint64_t>::max();
  const double relative = relative_difference(d);
  ordered_json object{{"tick", d.tick},
                      {"time", d.time},
                      {"channel", d.channel},
                      {"element", d.element},
                      {"expected", if_numbers(d.expected)},
                      {"actual", if_numbers(d.actual)},
                      {"difference", if_numbers(d.difference)},
                      {"relative", std::isnan(relative) ? ordered_json() : number_json(relative)},
                      {"ulps", comparable ? ordered_json(d.ulps) : ordered_json()},
                      {"tolerance", if_numbers(d.tolerance)},
                      {"times_tolerance", if_numbers(times_tolerance(d.judged(), d.tolerance))},
                      {"unit", d.unit},
                      {"note", d.note},
                      {"stage", to_string(d.stage)}};
  if (d.distance_from_envelope) object["beside"] = number_json(*d.distance_from_envelope);
  return object;
}

ordered_json object_of(const ChannelComparison& channel) {
  return {{"channel", channel.channel},
          {"stage", to_string(channel.stage)},
          {"channels", channel.channels},
          {"group", channel.group},
          {"of_events", channel.of_events},
          {"values", channel.values},
          {"differing", channel.differing},
          {"in_noise", channel.in_noise},
          {"beyond", channel.beyond},
          {"blanked", channel.blanked},
          {"missing", channel.missing},
          {"extra", channel.extra},
          {"first", json_of(channel.first ? channel.first : channel.first_bit)},
          {"worst", json_of(channel.worst)}};
}

ordered_json object_of(const EventDifference& event) {
  return {{"event", event.event},
          {"what", event.what},
          {"expected", or_null(event.expected)},
          {"actual", or_null(event.actual)},
          {"beyond", event.beyond}};
}

template <class T>
ordered_json json_array(const std::vector<T>& items) {
  ordered_json list = ordered_json::array();
  for (const T& item : items) list.push_back(object_of(item));
  return list;
}

}  // namespace

ordered_json json_of(const std::optional<Divergence>& divergence) {
  return divergence ? object_of(*divergence) : ordered_json();
}

ordered_json json_of(const Comparison& comparison) {
  ordered_json warnings = ordered_json::array();
  for (const Diagnostic& warning : comparison.warnings) warnings.push_back(to_string(warning));
  return {{"verdict", verdict(comparison)},
          {"equal", comparison.equal},
          {"within", comparison.within},
          {"agreement", to_string(comparison.agreement)},
          {"first", json_of(comparison.first ? comparison.first : comparison.first_bit)},
          {"first_bit", json_of(comparison.first_bit)},
          {"worst", json_of(comparison.worst)},
          {"explanation", comparison.explanation},
          {"ticks", comparison.ticks},
          {"values", comparison.values},
          {"pictures", comparison.pictures},
          {"differing", comparison.differing},
          {"in_noise", comparison.in_noise},
          {"beyond", comparison.beyond},
          {"blanked", comparison.blanked},
          {"channels", json_array(comparison.channels)},
          {"equal_channels", comparison.equal_channels},
          {"events", json_array(comparison.event_differences)},
          {"remarks", comparison.remarks},
          {"warnings", warnings}};
}

std::string text_of(const ordered_json& object) {
  // a file name that isn't UTF-8 must not make the report fail
  return object.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::string to_json(const Divergence& divergence) { return text_of(object_of(divergence)); }

std::string to_json(const Comparison& comparison) { return text_of(json_of(comparison)); }

}  // namespace rehearse
