#include "select.h"

#include <rehearse/messages.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/mcap/glob.h"
#include "model/text.h"

namespace rehearse::mcap {

namespace {

constexpr std::uint64_t ns_per_s = 1'000'000'000;
constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

bool is_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return '0' <= c && c <= '9'; });
}

/// a + b, limited to never.
std::uint64_t add(std::uint64_t a, std::uint64_t b) { return a > never - b ? never : a + b; }

std::vector<std::uint16_t> tick_channels(const Reader& reader) {
  std::vector<std::uint16_t> ids;
  for (const auto& [id, channel] : reader.channels()) {
    const Schema* schema = reader.schema_of(channel);
    if (schema != nullptr && schema->name == msg::Tick::type_name && channel.message_encoding == "cdr") {
      ids.push_back(id);
    }
  }
  return ids;
}

}  // namespace

Result<TimeBound> parse_time_bound(std::string_view text) {
  const auto refuse = [whole = std::string(text)] {
    return error(fmt::format("'{}' is no time", whole),
                 "seconds on the file's clock, as 3.5; +3.5 counts from its first message");
  };
  TimeBound moment;
  moment.after_first = text.starts_with('+');
  if (moment.after_first) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const std::string_view whole = text.substr(0, point);
  std::string fraction(text.substr(std::min(point + 1, text.size())));
  if ((whole.empty() && fraction.empty()) || !is_digits(whole) || !is_digits(fraction) || fraction.size() > 9) {
    return refuse();
  }
  fraction.resize(9, '0');
  const auto seconds = whole.empty() ? 0 : number_in<std::uint64_t>(whole);
  const auto rest = number_in<std::uint64_t>(fraction);
  if (!seconds || *seconds > (never - *rest) / ns_per_s) return refuse();
  moment.ns = *seconds * ns_per_s + *rest;
  return moment;
}

Result<TickSpan> parse_tick_span(std::string_view text) {
  const auto refuse = [whole = std::string(text)] {
    return error(fmt::format("'{}' is no span of ticks", whole), "10..20, 10.., ..20 or 10");
  };
  const std::size_t dots = text.find("..");
  const std::string_view first = text.substr(0, dots);
  const std::string_view last = dots == std::string_view::npos ? first : text.substr(dots + 2);
  TickSpan span{number_in<std::int64_t>(first), number_in<std::int64_t>(last)};
  if ((!span.first && !first.empty()) || (!span.last && !last.empty()) || (!span.first && !span.last)) return refuse();
  if (span.first && span.last && *span.last < *span.first) return refuse();
  return span;
}

bool Selection::takes_topic(std::string_view topic) const {
  return topics.empty() ||
         std::any_of(topics.begin(), topics.end(), [&](const std::string& pattern) { return matches(pattern, topic); });
}

Result<Selector> Selector::of(Selection selection, Reader& reader) {
  Selector selector(std::move(selection));
  if (const auto known = selector.check_topics(reader); !known) return known.errors();
  const Selection& chosen = selector.selection_;
  const bool counts = (chosen.from && chosen.from->after_first) || (chosen.until && chosen.until->after_first);
  selector.begin_at(counts ? first_log_time(reader).value_or(0) : 0);
  if (chosen.ticks) {
    if (const auto found = selector.find_ticks(reader); !found) return found.errors();
  }
  return selector;
}

Result<void> Selector::check_topics(const Reader& reader) const {
  for (const std::string& pattern : selection_.topics) {
    const bool found = std::any_of(reader.channels().begin(), reader.channels().end(),
                                   [&](const auto& entry) { return matches(pattern, entry.second.topic); });
    if (!found)
      return error_in(reader.name(), fmt::format("no topic matches '{}'", pattern),
                      "rehearse info lists the topics; * stands for any text");
  }
  return {};
}

/// Finds the times of the first selected tick and of the next tick after the last; all messages between belong to the
/// ticks.
Result<void> Selector::find_ticks(Reader& reader) {
  const auto refuse = [&](std::string message) { return error_in(reader.name(), std::move(message)); };
  const std::vector<std::uint16_t> channels = tick_channels(reader);
  if (channels.empty()) return refuse(fmt::format("it has no ticks: no channel is a {}", msg::Tick::type_name));
  const std::int64_t first = selection_.ticks->first.value_or(std::numeric_limits<std::int64_t>::min());
  const std::int64_t last = selection_.ticks->last.value_or(std::numeric_limits<std::int64_t>::max());
  std::uint64_t begin = never, end = never;
  std::optional<std::int64_t> least, greatest;
  // The caller's own pass will report the damage of the file.
  static_cast<void>(reader.for_each_message(
      [&](const Message& message) {
        CdrReader payload(message.data);
        msg::Tick tick;
        if (!msg::decode(payload, tick)) return true;
        least = std::min(least.value_or(tick.tick), tick.tick);
        greatest = std::max(greatest.value_or(tick.tick), tick.tick);
        if (first <= tick.tick && tick.tick <= last) begin = std::min(begin, message.log_time);
        if (tick.tick > last) end = std::min(end, message.log_time);
        return true;
      },
      channels));
  if (!least) return refuse("it has no ticks: no message states a tick");
  if (begin == never)
    return refuse(fmt::format("it doesn't have these ticks: it has ticks {} to {}", *least, *greatest));
  begin_ = std::max(begin_, begin);
  if (end != never) end_ = std::min(end_.value_or(never), end);
  return {};
}

void Selector::begin_at(std::uint64_t first) {
  const auto time_of = [&](const TimeBound& moment) { return moment.after_first ? add(first, moment.ns) : moment.ns; };
  if (selection_.from) begin_ = time_of(*selection_.from);
  if (selection_.until) end_ = time_of(*selection_.until);
}

std::optional<std::uint64_t> first_log_time(Reader& reader) {
  if (const auto& stated = reader.statistics()) {
    if (stated->message_count == 0) return std::nullopt;
    return stated->message_start_time;
  }
  std::optional<std::uint64_t> first;
  static_cast<void>(reader.for_each_message([&](const Message& message) {
    first = std::min(first.value_or(message.log_time), message.log_time);
    return true;
  }));
  return first;
}

}  // namespace rehearse::mcap
