// What a comparison found, in words, as a table, and as JSON.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "compare_parts.h"
#include "report_json.h"

namespace rehearse {
namespace {

using nlohmann::ordered_json;

std::string counted(std::int64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string place_text(const Divergence& d) {
  return fmt::format("tick {} ({} s), {}{}{}", d.tick, d.time, d.channel, d.element.empty() ? "" : " ", d.element);
}

std::string worst_text(const ChannelComparison& channel) {
  if (!channel.worst) return channel.first_bit->note;
  const Divergence& worst = *channel.worst;
  const double times = times_tolerance(worst.difference, worst.tolerance);
  const std::string unit = worst.unit.empty() || worst.unit == "pixels" ? "" : " " + worst.unit;
  if (!std::isfinite(times)) return fmt::format("{:.3g}{} at tick {}", worst.difference, unit, worst.tick);
  return fmt::format("{:.3g}{} at tick {}, {:.3g} times its tolerance", worst.difference, unit, worst.tick, times);
}

ordered_json number(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  return value;
}

}  // namespace

ordered_json json_of(const std::optional<Divergence>& divergence) {
  if (!divergence) return nullptr;
  const Divergence& d = *divergence;
  const bool of_numbers = d.note.empty();
  ordered_json object{{"tick", d.tick}, {"time", d.time}, {"channel", d.channel}, {"element", d.element}};
  object["expected"] = of_numbers ? number(d.expected) : ordered_json();
  object["actual"] = of_numbers ? number(d.actual) : ordered_json();
  const bool comparable = of_numbers && d.ulps != std::numeric_limits<std::uint64_t>::max();
  object["ulps"] = comparable ? ordered_json(d.ulps) : ordered_json();
  object["stage"] = to_string(d.stage);
  return object;
}

std::string text_of(const ordered_json& object) {
  // a file name that isn't UTF-8 must not make the report fail
  return object.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::string verdict(const Comparison& comparison) {
  if (!comparison.within) return "differs at " + to_string(*comparison.first);
  if (comparison.equal)
    return fmt::format("equal bit for bit: {}, {}, {}", counted(comparison.ticks, "tick"),
                       counted(comparison.values - comparison.pictures, "number"),
                       counted(comparison.pictures, "picture"));
  const std::string since = fmt::format("bits differ from {} on", place_text(*comparison.first_bit));
  if (!comparison.worst) return fmt::format("within tolerance: every value is the same, but {}", since);
  const Divergence& worst = *comparison.worst;
  return fmt::format("within tolerance: {} of {} values differ, the worst by {:.2g} of its tolerance ({}); {}",
                     comparison.differing, comparison.values, times_tolerance(worst.difference, worst.tolerance),
                     place_text(worst), since);
}

std::string table(const Comparison& comparison) {
  constexpr std::size_t channels_shown = 7, remarks_shown = 2;
  if (comparison.equal) return {};
  std::string text = fmt::format("  {:<11}{:>9}{:>9}{:>9}  {:<44} {}\n", "stage", "values", "differ", "beyond",
                                 "channel, by first difference", "worst");
  std::size_t shown = 0;
  for (const ChannelComparison& channel : comparison.channels) {
    if (shown++ == channels_shown) break;
    text += fmt::format("  {:<11}{:>9}{:>9}{:>9}  {:<44} {}\n", to_string(channel.stage), channel.values,
                        channel.differing, channel.beyond,
                        fmt::format("{} @{}", channel.channel, channel.first_bit->tick), worst_text(channel));
  }
  if (comparison.channels.size() > channels_shown)
    text += fmt::format("  and {} more\n",
                        counted(static_cast<std::int64_t>(comparison.channels.size() - channels_shown), "channel"));
  for (std::size_t i = 0; i < std::min(remarks_shown, comparison.remarks.size()); ++i)
    text += "  note: " + comparison.remarks[i] + "\n";
  if (comparison.remarks.size() > remarks_shown)
    text += fmt::format("  and {} more\n",
                        counted(static_cast<std::int64_t>(comparison.remarks.size() - remarks_shown), "note"));
  return text;
}

std::string to_json(const Comparison& comparison) {
  const ordered_json object{{"verdict", verdict(comparison)},
                            {"equal", comparison.equal},
                            {"within", comparison.within},
                            {"first", json_of(comparison.first ? comparison.first : comparison.first_bit)}};
  return text_of(object);
}

}  // namespace rehearse
