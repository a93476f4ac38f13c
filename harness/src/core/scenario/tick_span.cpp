#include "tick_span.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "base/text.h"

namespace rehearse {
namespace {

constexpr double most_ticks = 1e15;

std::optional<std::int64_t> whole_number(std::string_view text) {
  const auto number = number_in<std::int64_t>(text);
  return number && *number >= 0 ? number : std::nullopt;
}

/// "3.2s", or "3.2" before "..".
std::optional<double> seconds(std::string_view text, bool needs_unit) {
  const bool has_unit = text.ends_with('s');
  if (has_unit) text.remove_suffix(1);
  const auto number = number_in<double>(text);
  if ((needs_unit && !has_unit) || !number || !(*number >= 0.0)) return std::nullopt;
  return number;
}

}  // namespace

Diagnostic error_at(const WordPlace& place, const std::string& message) {
  std::size_t column = 0;  // a byte that continues a character has no column
  for (const char c : place.text.substr(0, place.begin)) column += (c & 0xC0) != 0x80;
  return error(fmt::format("{}\n  {}\n  {}{}", message, place.text, std::string(column, ' '),
                           "^" + std::string(place.size > 1 ? place.size - 1 : 0, '~')));
}

Result<TickSpan> parse_span(std::string_view text, std::size_t begin, double time_step) {
  const std::string_view span = text.substr(begin);
  const auto wrong = [&](const std::string& why) {
    return error_at({text, begin, span.size()},
                    fmt::format("'{}' {}; expected tick:1200..1300, tick:1200, 3.2s..3.4s or 3.2s", span, why));
  };
  const bool in_ticks = span.starts_with("tick:");
  const std::string_view body = in_ticks ? span.substr(5) : span;
  const std::size_t dots = body.find("..");
  const std::string_view from = body.substr(0, dots);
  const std::string_view until = dots == std::string_view::npos ? std::string_view() : body.substr(dots + 2);
  TickSpan ticks;
  if (in_ticks) {
    const auto first = whole_number(from), last = dots == std::string_view::npos ? first : whole_number(until);
    if (!first || !last) return wrong("is no span of ticks");
    ticks = {*first, *last};
  } else {
    const auto first = seconds(from, dots == std::string_view::npos);
    const auto last = dots == std::string_view::npos ? first : seconds(until, true);
    if (!first || !last || *last / time_step > most_ticks || *first / time_step > most_ticks)
      return wrong("is no span of time");
    constexpr double rounding = 1e-6;  // of a tick: 0.3 s may be a little more than 300 times 0.001 s
    ticks.first = std::llround(std::ceil(*first / time_step - rounding));
    ticks.last = std::llround(std::ceil(*last / time_step - rounding)) - 1;
    if (dots == std::string_view::npos) ticks.first = ticks.last = std::llround(*first / time_step);
  }
  if (ticks.last < ticks.first) return wrong("contains no tick");
  return ticks;
}

}  // namespace rehearse
