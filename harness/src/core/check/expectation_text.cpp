#include "expectation_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "base/glob.h"
#include "base/names.h"
#include "core/kinds/channel_name.h"
#include "core/kinds/kind.h"

namespace rehearse {

std::string time_text(double seconds) { return fmt::format("{:.12g} s", seconds); }

std::string number_text(double value, const std::string& unit, const Expectation& expectation) {
  if (expectation.degrees && unit == "rad") return fmt::format("{:.6g} deg", value * 180.0 / std::numbers::pi);
  return fmt::format("{:.6g}{}{}", value, unit.empty() ? "" : " ", unit);
}

namespace {

std::string bounds_text(const Expectation& e, const std::string& unit) {
  if (e.near) return fmt::format("within {} of {}", number_text(*e.within, unit, e), number_text(*e.near, unit, e));
  std::string text;
  if (e.above) text = "above " + number_text(*e.above, unit, e);
  if (e.below) text += (text.empty() ? "below " : " and below ") + number_text(*e.below, unit, e);
  return text;
}

std::string span_text(const Expectation& e) {
  if (e.at_end) return " at the end";
  if (e.at) return fmt::format(" at {} s", *e.at);
  std::string text = e.sometime ? " at some time" : "";
  const bool is_told = e.since && e.from == e.since;  // as the beginning of the change
  if (e.from && e.until && !is_told) return text + fmt::format(" from {} s until {} s", *e.from, *e.until);
  if (e.until) return text + fmt::format(" until {} s", *e.until);
  if (e.from && !is_told) return text + fmt::format(" from {} s on", *e.from);
  return text;
}

/// "'SR1/KNEE/q'": a name as it is written in any expression.
std::string quoted(const std::string& name, char quote) {
  std::string text(1, quote);
  for (const char c : name) text += c == quote ? std::string(2, quote) : std::string(1, c);
  return text + quote;
}

std::string_view word_of(Expectation::Quantifier quantifier) {
  switch (quantifier) {
    case Expectation::Quantifier::always: return "always";
    case Expectation::Quantifier::eventually: return "eventually";
    case Expectation::Quantifier::never: return "never";
  }
  return "";
}

std::string text_of_expression(const Expectation& e) {
  std::string text = fmt::format("{} {}", word_of(e.quantifier), e.expression);
  const bool belongs_to_condition = e.lasting && e.except.empty();
  if (belongs_to_condition) text += fmt::format(" for {} s", *e.lasting);
  if (e.delay) text += fmt::format(" within {} s", *e.delay);
  if (!e.after.empty()) text += " after " + e.after;
  if (!e.except.empty()) text += " except " + e.except;
  if (e.lasting && !belongs_to_condition) text += fmt::format(" for {} s", *e.lasting);
  if (!span_text(e).empty()) text += "," + span_text(e);
  return text;
}

}  // namespace

std::string text_of(const Expectation& e, const std::string& unit) {
  if (e.subject == Expectation::Subject::expression) return text_of_expression(e);
  if (e.subject == Expectation::Subject::event) return fmt::format("an event \"{}\"{}", e.pattern, span_text(e));
  if (e.subject == Expectation::Subject::no_event) return fmt::format("no event \"{}\"{}", e.pattern, span_text(e));
  std::string quantity = e.pattern;
  if (e.since) quantity = fmt::format("the change of {} since {} s", quantity, *e.since);
  if (e.absolute) quantity = "the magnitude of " + quantity;
  return fmt::format("{} {}{}", quantity, bounds_text(e, unit), span_text(e));
}

std::string condition_of(const Expectation& e, const std::string& series) {
  const std::string name = quoted(series, '\'');
  std::string value = name;
  if (e.since) value = fmt::format("({} - at({}, {} s))", name, name, *e.since);
  if (e.absolute) value = fmt::format("abs({})", value);
  if (e.near) return fmt::format("abs({} - {}) <= {}", value, *e.near, *e.within);
  std::string text;
  if (e.above) text = fmt::format("{} > {}", value, *e.above);
  if (e.below) text += fmt::format("{}{} < {}", text.empty() ? "" : " && ", value, *e.below);
  return text.empty() ? "true" : text;
}

std::string formula_of(const Expectation& e) {
  switch (e.subject) {
    case Expectation::Subject::event: return fmt::format("eventually event({})", quoted(e.pattern, '"'));
    case Expectation::Subject::no_event: return fmt::format("never event({})", quoted(e.pattern, '"'));
    case Expectation::Subject::expression: return text_of_expression(e);
    case Expectation::Subject::series: break;
  }
  return fmt::format("{} {}", e.sometime ? "eventually" : "always", condition_of(e, e.pattern));
}

std::string missing_margin(const ExpectationResult& result) {
  const auto& demand = result.expectation.margin;
  if (!demand || !result.closest) return {};
  const ClosestPlace& closest = *result.closest;
  if (demand->angle && !closest.unit.empty() && !closest.unit.starts_with("rad"))
    return fmt::format("the margin {} is an angle, and {} is compared", demand->text, closest.unit);
  if (demand->is_share && !closest.share) return "the bound is 0, of which a margin can't be a share";
  if ((demand->is_share ? *closest.share : closest.margin) >= demand->least) return {};
  return fmt::format("its margin is less than {}: {}", demand->text, closest_text(result).substr(9));
}

std::string without_sample_text(const std::vector<std::string>& series) {
  constexpr std::size_t most_shown = 6;
  return fmt::format("{} {} no sample", listed(series, most_shown), series.size() == 1 ? "has" : "have");
}

namespace {

/// Of a channel whose messages tell its elements: those of which its metadata state the unit, as `unit:KNEE/q`, or that
/// of their array, as `unit:ranges`.
void add_stated_series(const TraceChannel& channel, std::string_view pattern, std::vector<std::string>& found) {
  constexpr std::string_view key_begin = "unit:";
  for (const auto& [key, unit] : channel.metadata) {
    if (!key.starts_with(key_begin)) continue;
    std::string name = series_name(channel.topic, key.substr(key_begin.size()));
    if (matches(pattern, name))
      found.push_back(std::move(name));
    else if (pattern.starts_with(name + "/"))
      found.emplace_back(pattern);
  }
}

}  // namespace

std::vector<std::string> unsampled_series(const Trace& run, std::string_view pattern) {
  std::vector<std::string> found;
  for (const TraceChannel& channel : run.channels()) {
    const ChannelKind kind = ChannelName::parse(channel.topic).kind;
    if (!channel.columns.empty() || kind == ChannelKind::other || !form_of(kind).has_series) continue;
    if (!form_of(kind).has_fixed_elements) {
      add_stated_series(channel, pattern, found);
      continue;
    }
    for (const ChannelElement& element : elements_of(kind))
      if (std::string name = series_name(channel.topic, element.name); matches(pattern, name))
        found.push_back(std::move(name));
  }
  return found;
}

std::string closest_text(const ExpectationResult& result) {
  if (!result.closest) return {};
  const ClosestPlace& closest = *result.closest;
  std::string text = fmt::format("closest: {} at tick {} ({})", closest.text, closest.tick, time_text(closest.time));
  if (closest.share) text += fmt::format(", margin {:.3g} %", *closest.share * 100.0);
  return text;
}

std::string closest_of(const std::vector<ExpectationResult>& results) {
  const auto left = [](const ExpectationResult& result) {
    const double none = std::numeric_limits<double>::infinity();
    return result.closest ? result.closest->share.value_or(none) : none;
  };
  const auto closest = std::ranges::min_element(results, {}, left);
  if (first_violation(results) || closest == results.end() || !closest->closest) return {};
  return results.size() == 1 ? closest_text(*closest) : fmt::format("{}: {}", closest_text(*closest), closest->text);
}

std::string closest_lines(const std::vector<ExpectationResult>& results) {
  std::string lines;
  for (const ExpectationResult& result : results)
    if (result.closest) lines += fmt::format("  {}: {}\n", closest_text(result), result.text);
  return lines;
}

}  // namespace rehearse
