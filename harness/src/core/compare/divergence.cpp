#include <fmt/format.h>
#include <rehearse/compare.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "divergence_text.h"

namespace rehearse {
namespace {

/// An integer in the order of the doubles; 0 and -0 have the same one.
std::int64_t ordinal(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}

}  // namespace

bool identical(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

std::uint64_t ulps_between(double a, double b) {
  if (identical(a, b)) return 0;
  if (std::isnan(a) || std::isnan(b)) return std::numeric_limits<std::uint64_t>::max();
  const std::int64_t low = std::min(ordinal(a), ordinal(b));
  const std::int64_t high = std::max(ordinal(a), ordinal(b));
  return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
}

double difference_between(double expected, double actual) {
  return std::isnan(expected) && std::isnan(actual) ? 0.0 : std::abs(actual - expected);
}

void put_numbers(Divergence& divergence, double expected, double actual, std::string_view unit) {
  divergence.expected = expected;
  divergence.actual = actual;
  divergence.difference = difference_between(expected, actual);
  divergence.ulps = ulps_between(expected, actual);
  divergence.unit = unit;
}

void Differences::add(Divergence found, bool is_beyond) {
  const auto is_earlier = [&](const std::optional<Divergence>& than) { return !than || found.tick < than->tick; };
  ++values_different;
  if (is_beyond && is_earlier(beyond)) beyond = found;
  if (!worst || found.difference > worst->difference) worst = found;
  if (is_earlier(first)) first = std::move(found);
}

double relative_difference(const Divergence& d) {
  const bool of_these_two = d.note.empty() && d.difference == std::abs(d.actual - d.expected);
  return of_these_two ? d.difference / std::abs(d.expected) : std::numeric_limits<double>::quiet_NaN();
}

double times_tolerance(double difference, double tolerance) {
  if (difference == 0.0) return 0.0;
  return tolerance > 0.0 ? difference / tolerance : std::numeric_limits<double>::infinity();
}

namespace {

/// Two numbers for a person: with as many digits as distinguish them, 4 to 7, and all digits before the point.
std::pair<std::string, std::string> texts_of(double a, double b) {
  std::pair<std::string, std::string> texts;
  const double larger = std::max(std::abs(a), std::abs(b));
  const int before_point = larger >= 1.0 && larger < 1e7 ? static_cast<int>(std::log10(larger)) + 1 : 1;
  for (int digits = std::max(4, before_point); digits <= 7; ++digits) {
    texts = {fmt::format("{:.{}g}", a, digits), fmt::format("{:.{}g}", b, digits)};
    if (texts.first != texts.second) break;
  }
  return texts;
}

/// The exact number up to a million; beyond, two digits.
std::string ulps_text(std::uint64_t ulps) {
  constexpr std::uint64_t countable = 1'000'000;
  if (ulps == 1) return "1 ULP";
  return ulps <= countable ? fmt::format("{} ULPs", ulps) : fmt::format("{:.2g} ULPs", static_cast<double>(ulps));
}

}  // namespace

std::string to_string(const Divergence& d) {
  return describe(d, fmt::format("tick {} ({:.10g} s)", d.tick, d.time), true);
}

std::string describe(const Divergence& d, const std::string& where, bool with_stage) {
  const std::string place = fmt::format("{}: {}{}{}", where, d.channel, d.element.empty() ? "" : " ", d.element);
  const auto stage = [&](const char* before, const char* after) {
    return with_stage ? fmt::format("{}stage: {}{}", before, to_string(d.stage), after) : std::string();
  };
  if (!d.note.empty()) return fmt::format("{}: {}{}", place, d.note, stage(" (", ")"));
  const std::string unit = d.unit.empty() ? "" : " " + d.unit;
  const auto [actual, expected] = texts_of(d.actual, d.expected);
  if (std::isnan(d.difference))
    return fmt::format("{} is {}{}, expected {}{} (not comparable{})", place, actual, unit, expected, unit,
                       stage("; ", ""));
  const double share = relative_difference(d);
  const std::string relative = std::isfinite(share) ? fmt::format("relative {:.3g}, ", share) : "";
  const std::string beside =
      d.distance_from_envelope
          ? fmt::format(", {:.6g}{} from the golden's values within lead and lag", *d.distance_from_envelope, unit)
          : "";
  const std::string bound = d.tolerance > 0.0 ? fmt::format("{}, {:.3g} times the tolerance of {:g}{}", beside,
                                                            d.judged() / d.tolerance, d.tolerance, unit)
                                              : beside;
  return fmt::format("{} is {}{}, expected {}{}: off by {:.6g}{} ({}{}{}{})", place, actual, unit, expected, unit,
                     d.difference, unit, relative, ulps_text(d.ulps), bound, stage("; ", ""));
}

}  // namespace rehearse
