#include <fmt/format.h>
#include <fmt/ranges.h>
#include <rehearse/compare.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/kinds/channel_name.h"
#include "divergence_text.h"

namespace rehearse {
namespace {

/// An integer in the order of the doubles; 0 and -0 have the same one.
std::int64_t ordinal(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits >= 0 ? bits : std::numeric_limits<std::int64_t>::min() - bits;
}

/// The order of cause and effect of the stages within one tick.
int rank_of(Stage stage) {
  switch (stage) {
    case Stage::physics: return 0;
    case Stage::sensors: return 1;
    case Stage::renderer: return 2;
    case Stage::inputs: return 3;
    case Stage::controller: return 4;
    case Stage::costs: return 5;
  }
  return 6;
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

std::optional<std::string> name_of_time(std::string_view seconds, std::string_view nanoseconds) {
  const auto stem_of = [](std::string_view path, std::string_view last) -> std::optional<std::string_view> {
    if (path == last) return std::string_view();
    if (!path.ends_with(last) || path[path.size() - last.size() - 1] != '/') return std::nullopt;
    return path.substr(0, path.size() - last.size() - 1);
  };
  const auto stem = stem_of(seconds, "sec");
  if (!stem || stem != stem_of(nanoseconds, "nanosec")) return std::nullopt;
  return std::string(*stem);
}

std::int64_t time_of_parts(std::int64_t seconds, std::uint64_t nanoseconds) {
  return seconds * 1'000'000'000 + static_cast<std::int64_t>(nanoseconds);
}

void put_times(Divergence& divergence, std::int64_t expected, std::int64_t actual) {
  const auto seconds = [](std::int64_t time) { return static_cast<double>(time) / 1e9; };
  const auto text = [](std::int64_t time) {
    const std::uint64_t size = time < 0 ? 0 - static_cast<std::uint64_t>(time) : static_cast<std::uint64_t>(time);
    return fmt::format("{}{}.{:09} s", time < 0 ? "-" : "", size / 1'000'000'000, size % 1'000'000'000);
  };
  const std::uint64_t apart = actual > expected
                                  ? static_cast<std::uint64_t>(actual) - static_cast<std::uint64_t>(expected)
                                  : static_cast<std::uint64_t>(expected) - static_cast<std::uint64_t>(actual);
  put_numbers(divergence, seconds(expected), seconds(actual), "s");
  divergence.difference = static_cast<double>(apart) / 1e9;
  divergence.ulps = std::numeric_limits<std::uint64_t>::max();  // no number that was recorded
  if (identical(divergence.expected, divergence.actual))        // since 1970: doubles are 0.24 us apart
    divergence.note =
        fmt::format("is {}, expected {}: off by {:.6g} s", text(actual), text(expected), divergence.difference);
}

bool comes_before(const Divergence& a, const Divergence& b) {
  if ((a.stage == Stage::costs) != (b.stage == Stage::costs)) return b.stage == Stage::costs;
  return a.tick != b.tick ? a.tick < b.tick : rank_of(a.stage) < rank_of(b.stage);
}

bool is_worse(const Divergence& a, const Divergence& b) {
  const auto badness = [](const Divergence& d) {
    if (std::isnan(d.judged())) return std::numeric_limits<double>::infinity();
    if (d.judged() > 0.0 && d.tolerance == 0.0) return 1.0;  // exact: as bad as a value at its tolerance
    return times_tolerance(d.judged(), d.tolerance);
  };
  const double of_a = badness(a), of_b = badness(b);
  return of_a > of_b || (of_a == of_b && a.tolerance == 0.0 && a.judged() > b.judged());
}

void Differences::add(Divergence found, bool is_beyond) {
  const auto is_earlier = [&](const std::optional<Divergence>& than) { return !than || found.tick < than->tick; };
  ++values_different;
  const auto is_larger = [](const Divergence& a, const Divergence& b) {
    return times_tolerance(a.difference, a.tolerance) > times_tolerance(b.difference, b.tolerance);
  };
  if (!largest || is_larger(found, *largest)) largest = found;
  if (found.note.empty()) most_ulps = std::max(most_ulps, found.ulps);
  if (is_beyond && is_earlier(beyond)) beyond = found;
  if (!worst || is_worse(found, *worst)) worst = found;
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

/// Two numbers for a person: with as many digits as distinguish them, 4 to 7, of times to 16, and all digits before the
/// point.
std::pair<std::string, std::string> texts_of(double a, double b, bool are_times) {
  std::pair<std::string, std::string> texts;
  const double larger = std::max(std::abs(a), std::abs(b));
  const int before_point = larger >= 1.0 && larger < 1e7 ? static_cast<int>(std::log10(larger)) + 1 : 1;
  for (int digits = std::max(4, before_point); digits <= (are_times ? 16 : 7); ++digits) {
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

/// How many times its tolerance a difference is: "14", "1.2e+09".
std::string times_text(double times) {
  return times < 10.0 || times >= 1e6 ? fmt::format("{:.2g}", times) : fmt::format("{:.0f}", times);
}

/// True for two numbers whose difference is beyond a tolerance that allows some difference.
bool has_left_a_tolerance(const Divergence& d) {
  return d.note.empty() && d.tolerance > 0.0 && std::isfinite(d.judged()) && d.judged() > d.tolerance;
}

/// "0.0136 N·m (14 times) at tick 739"
std::string amount_text(const Divergence& d, const char* tick) {
  return fmt::format("{:.3g}{}{} ({} times) at {} {}", d.judged(), d.unit.empty() ? "" : " ", d.unit,
                     times_text(d.judged() / d.tolerance), tick, d.tick);
}

std::string describe(const Divergence& d, const std::string& where, bool with_stage, bool in_full) {
  const std::string place = fmt::format("{}: {}{}{}", where, d.channel, d.element.empty() ? "" : " ", d.element);
  std::vector<std::string> remarks;
  const auto in_parentheses = [&remarks] {
    return remarks.empty() ? std::string() : fmt::format(" ({})", fmt::join(remarks, "; "));
  };
  const auto add_stage = [&] {
    if (with_stage) remarks.push_back(fmt::format("stage: {}", to_string(d.stage)));
  };
  if (!d.note.empty()) {
    add_stage();
    return fmt::format("{}: {}{}", place, d.note, in_parentheses());
  }
  const std::string unit = d.unit.empty() ? "" : " " + d.unit;
  const auto [actual, expected] = texts_of(d.actual, d.expected, d.unit == "s");
  const std::string values = fmt::format("{} is {}{}, expected {}{}", place, actual, unit, expected, unit);
  if (std::isnan(d.difference)) {
    remarks.push_back("not comparable");
    add_stage();
    return values + in_parentheses();
  }
  std::vector<std::string> sizes;
  const double share = relative_difference(d);
  const bool is_rounding = d.ulps < few_ulps || in_full;
  if (is_rounding && std::isfinite(share)) sizes.push_back(fmt::format("relative {:.3g}", share));
  if (is_rounding) sizes.push_back(ulps_text(d.ulps));
  if (d.distance_from_envelope)
    sizes.push_back(
        fmt::format("{:.6g}{} from the golden's values within lead and lag", *d.distance_from_envelope, unit));
  if (d.tolerance > 0.0)
    sizes.push_back(fmt::format("{:.3g} times the tolerance of {:g}{}", d.judged() / d.tolerance, d.tolerance, unit));
  if (!sizes.empty()) remarks.push_back(fmt::format("{}", fmt::join(sizes, ", ")));
  add_stage();
  return fmt::format("{}: off by {:.6g}{}{}", values, d.difference, unit, in_parentheses());
}

}  // namespace

std::string few_ulps_text(std::uint64_t ulps) { return ulps < few_ulps ? ulps_text(ulps) : ""; }

std::string when_text(const Divergence& d) { return fmt::format("tick {} ({:.10g} s)", d.tick, d.time); }

std::string to_string(const Divergence& d) { return describe(d, when_text(d), true); }

std::string describe(const Divergence& d, const std::string& where, bool with_stage) {
  return describe(d, where, with_stage, false);
}

std::string describe_in_full(const Divergence& d, const std::string& where) { return describe(d, where, true, true); }

std::string headline_of(const Divergence& first, const std::optional<Divergence>& worst, const HeadlineWords& words) {
  if (!has_left_a_tolerance(first))
    return words.before_differs + "differs at " + describe(first, words.when, words.has_ticks);
  std::string text =
      fmt::format("{}{} is beyond ±{:g}{}{}{} from {} on", words.before_beyond,
                  words.name.empty() ? series_name(first.channel, first.element) : words.name, first.tolerance,
                  first.unit.empty() ? "" : " ", first.unit,
                  first.distance_from_envelope ? " of the golden's values within lead and lag" : "", words.when);
  if (!worst) return text;
  const Divergence& most = has_left_a_tolerance(*worst) ? *worst : first;
  const bool is_same = most.channel == first.channel && most.element == first.element;
  return text +
         (is_same ? ", worst "
                  : fmt::format("; worst is {} by ",
                                words.name.empty() ? series_name(most.channel, most.element) : most.element)) +
         amount_text(most, words.has_ticks ? "tick" : "message");
}

}  // namespace rehearse
