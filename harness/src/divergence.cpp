#include <fmt/format.h>
#include <rehearse/divergence.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rehearse {
namespace {

/// Doubles in their order as integers; 0 and -0 share a place.
std::int64_t ordinal(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}

}  // namespace

std::string_view to_string(Stage stage) {
  switch (stage) {
    case Stage::inputs: return "inputs";
    case Stage::controller: return "controller";
    case Stage::physics: return "physics";
    case Stage::sensors: return "sensors";
    case Stage::renderer: return "renderer";
  }
  return "";
}

bool identical(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

std::uint64_t ulps_between(double a, double b) {
  if (identical(a, b)) return 0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint64_t>::max();
  const std::int64_t low = std::min(ordinal(a), ordinal(b));
  const std::int64_t high = std::max(ordinal(a), ordinal(b));
  return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
}

std::string to_string(const Divergence& d) {
  const std::string place =
      fmt::format("tick {} ({} s): {}{}{}", d.tick, d.time, d.channel, d.element.empty() ? "" : " ", d.element);
  if (!d.note.empty()) return fmt::format("{}: {} (stage: {})", place, d.note, to_string(d.stage));
  const std::string unit = d.unit.empty() ? "" : " " + d.unit;
  const std::string bound = d.tolerance > 0.0 ? fmt::format(", {:.3g} times the tolerance of {:g}{}",
                                                            d.difference / d.tolerance, d.tolerance, unit)
                                              : "";
  const std::string ulps =
      d.ulps == std::numeric_limits<std::uint64_t>::max() ? "not comparable" : fmt::format("{} ULPs", d.ulps);
  return fmt::format("{} is {}{}, expected {}{}: off by {:.6g}{} ({}{}; stage: {})", place, d.actual, unit, d.expected,
                     unit, d.difference, unit, ulps, bound, to_string(d.stage));
}

}  // namespace rehearse
