#include "select.h"

#include <rehearse/messages.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "base/glob.h"
#include "base/text.h"
#include "run_facts.h"

namespace rehearse::mcap {

namespace {

constexpr std::uint64_t ns_per_s = 1'000'000'000;
constexpr std::uint64_t wall_clock_begins = 100'000'000 * ns_per_s;  // 1973; no log lasts as long
constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

bool is_digits(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return '0' <= c && c <= '9'; });
}

/// A date in UTC as nanoseconds since 1970.
std::optional<std::uint64_t> parse_date(std::string_view text) {
  for (const std::string_view zone : {"Z", " UTC"})
    if (text.ends_with(zone)) {
      text.remove_suffix(zone.size());
      break;
    }
  constexpr std::string_view form = "0000-00-00T00:00:00";
  std::string whole(text.substr(0, form.size()));
  std::string fraction(text.substr(whole.size()));
  if (whole.size() == form.size() - 3) whole += ":00";
  if (whole.size() != form.size()) return std::nullopt;
  if (whole[10] == ' ') whole[10] = 'T';
  for (std::size_t i = 0; i < form.size(); ++i)
    if (form[i] == '0' ? !is_digits(whole.substr(i, 1)) : whole[i] != form[i]) return std::nullopt;
  if (!fraction.empty() && (fraction[0] != '.' || fraction.size() > 10 || !is_digits(fraction.substr(1))))
    return std::nullopt;
  fraction.resize(10, '0');
  const auto number = [&whole](std::size_t at, std::size_t size) { return *number_in<int>(whole.substr(at, size)); };
  const std::chrono::year_month_day day{std::chrono::year(number(0, 4)),
                                        std::chrono::month(static_cast<unsigned>(number(5, 2))),
                                        std::chrono::day(static_cast<unsigned>(number(8, 2)))};
  constexpr int last_year = 2500;  // nanoseconds of 64 bits end in 2554
  if (!day.ok() || number(0, 4) < 1970 || number(0, 4) > last_year) return std::nullopt;
  if (number(11, 2) > 23 || number(14, 2) > 59 || number(17, 2) > 59) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(day).time_since_epoch().count();
  const std::int64_t seconds = ((days * 24 + number(11, 2)) * 60 + number(14, 2)) * 60 + number(17, 2);
  return static_cast<std::uint64_t>(seconds) * ns_per_s + *number_in<std::uint64_t>(fraction.substr(1));
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
                 "seconds from the log's beginning, as 3.5, or a date, as 2026-11-26T12:00:00Z");
  };
  TimeBound moment;
  if (text.find('-', 1) != std::string_view::npos) {
    const auto date = parse_date(text);
    if (!date) return refuse();
    return TimeBound{*date, TimeOrigin::clock};
  }
  if (text.starts_with('+')) {
    moment.origin = TimeOrigin::first_message;
    text.remove_prefix(1);
  }
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
  if (moment.ns >= wall_clock_begins && moment.origin == TimeOrigin::beginning) moment.origin = TimeOrigin::clock;
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
         std::ranges::any_of(topics, [&](const std::string& pattern) { return matches(pattern, topic); });
}

Result<Selector> Selector::of(Selection selection, Reader& reader) {
  Selector selector(std::move(selection));
  REHEARSE_TRY(selector.check_topics(reader));
  REHEARSE_TRY(selector.find_span(reader));
  if (selector.selection_.ticks) {
    REHEARSE_TRY(selector.find_ticks(reader));
  }
  return selector;
}

Result<void> Selector::check_topics(const Reader& reader) const {
  for (const std::string& pattern : selection_.topics) {
    const bool found =
        std::ranges::any_of(reader.channels(), [&](const auto& entry) { return matches(pattern, entry.second.topic); });
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

/// Finds the log times of the span.
Result<void> Selector::find_span(Reader& reader) {
  if (!selection_.from && !selection_.until) return {};
  const auto times = log_times(reader);
  if (!times) return {};
  if (selection_.from) {
    begin_ = REHEARSE_TRY(moment_in(*selection_.from, reader));
  }
  if (selection_.until) {
    end_ = REHEARSE_TRY(moment_in(*selection_.until, reader));
  }
  if (begin_ <= times->second && (!end_ || (*end_ > times->first && *end_ > begin_))) return {};
  return mcap::refusal_of_empty(reader);
}

std::optional<Diagnostic> Selector::refusal_of_empty(const Reader& reader) const {
  if (selection_.takes_all_times()) return std::nullopt;
  return mcap::refusal_of_empty(reader);
}

Diagnostic refusal_of_empty(const Reader& reader) {
  return error_in(reader.name(), "nothing was recorded in the span that is asked for",
                  "rehearse info shows its begin and its end; times count from its beginning, or are dates");
}

namespace {

/// The log's time at which a recording of a robot's log begins [ns]; nullopt: it isn't one.
std::optional<std::uint64_t> start_of_log(const Reader& reader) {
  for (const Metadata& record : reader.metadata())
    if (const auto start = record.values.find(facts::log_start); start != record.values.end())
      return number_in<std::uint64_t>(start->second);
  return std::nullopt;
}

}  // namespace

Result<std::uint64_t> moment_in(const TimeBound& bound, Reader& reader) {
  const bool is_recording = !tick_channels(reader).empty();
  switch (bound.origin) {
    case TimeOrigin::first_message: {
      const auto times = log_times(reader);
      return add(times ? times->first : 0, bound.ns);
    }
    case TimeOrigin::beginning: {
      if (is_recording) return bound.ns;
      const auto times = log_times(reader);
      return add(times ? times->first : 0, bound.ns);
    }
    case TimeOrigin::clock: break;
  }
  if (!is_recording) return bound.ns;
  const auto start = start_of_log(reader);
  if (!start)
    return error_in(reader.name(), "its times count from the beginning of the run, and are no dates",
                    "expected seconds from its beginning, as 3.5");
  return bound.ns > *start ? bound.ns - *start : 0;
}

Result<double> seconds_in(const TimeBound& bound, Reader& reader) {
  const auto moment = REHEARSE_TRY(moment_in(bound, reader));
  return static_cast<double>(moment) * 1e-9;
}

std::optional<std::pair<std::uint64_t, std::uint64_t>> log_times(Reader& reader) {
  if (const auto& stated = reader.statistics()) {
    if (stated->message_count == 0) return std::nullopt;
    return std::pair{stated->message_start_time, stated->message_end_time};
  }
  std::optional<std::pair<std::uint64_t, std::uint64_t>> times;
  static_cast<void>(reader.for_each_message([&](const Message& message) {
    if (!times) times.emplace(message.log_time, message.log_time);
    times->first = std::min(times->first, message.log_time);
    times->second = std::max(times->second, message.log_time);
    return true;
  }));
  return times;
}

}  // namespace rehearse::mcap
