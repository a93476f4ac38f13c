// Selection: the messages of a file to use, by topic, by time and by tick. All verbs with --topics, --from, --until and
// --ticks share this rule.
//
// Times are log times. "3.5" is 3.5 s after the log's beginning: the start of the run in a recording of Rehearse, also
// in a part of it, and the first message in all other logs. "+3.5" is 3.5 s after the file's first message.
// "2026-11-26T12:00:00Z" is a moment on the log's clock. A span includes its beginning and excludes its end, so that
// consecutive pieces contain every message once. A span of ticks includes both.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse::mcap {

/// The moment from which a time is counted.
enum class TimeOrigin {
  beginning,      // of the run in a recording of Rehearse, else of the file
  first_message,  // of the file
  clock           // 0 of the log's clock: 1970 in most logs of robots
};

/// A time as written on a command line.
struct TimeBound {
  std::uint64_t ns = 0;  // [ns]
  TimeOrigin origin = TimeOrigin::beginning;

  bool operator==(const TimeBound&) const = default;
};

/// From "3.5" or "+3.5" [s], exact, with at most nine digits after the point; or from a date in UTC, as
/// "2026-11-26T12:00:00.5Z" or "2026-11-26 12:00:00.5 UTC". Seconds above 1e8 (three years) are since 1970, as cat
/// prints them.
Result<TimeBound> parse_time_bound(std::string_view text);

/// Numbers of ticks, both included; none: no bound.
struct TickSpan {
  std::optional<std::int64_t> first = std::nullopt;
  std::optional<std::int64_t> last = std::nullopt;

  bool operator==(const TickSpan&) const = default;
};

/// From "10..20", "10..", "..20" or "10".
Result<TickSpan> parse_tick_span(std::string_view text);

/// A member without a value selects everything.
struct Selection {
  std::vector<std::string> topics = {};           // globs (glob.h); a message is selected if any matches
  std::optional<TimeBound> from = std::nullopt;   // inclusive
  std::optional<TimeBound> until = std::nullopt;  // exclusive
  std::optional<TickSpan> ticks = std::nullopt;   // all data recorded in these ticks; needs a recording of Rehearse

  bool takes_topic(std::string_view topic) const;
  /// True if only topics are selected.
  bool takes_all_times() const { return !from && !until && !ticks; }
};

/// A Selection applied to a file.
class Selector {
 public:
  /// Finds the times of ticks and moments; reads all messages if the file's summary lacks them. Fails if a pattern
  /// matches no topic, if the file has none of the ticks, or if all of its messages are before or after the span.
  static Result<Selector> of(Selection selection, Reader& reader);

  bool takes(const Message& message) const {
    return takes_time(message.log_time) && takes_topic(message.channel->topic);
  }
  bool takes_topic(std::string_view topic) const { return selection_.takes_topic(topic); }
  bool takes_time(std::uint64_t log_time) const { return begin_ <= log_time && (!end_ || log_time < *end_); }

  /// The first selected log time [ns].
  std::uint64_t begin() const { return begin_; }
  /// The first log time after the selection [ns]; none: all later messages are selected.
  std::optional<std::uint64_t> end() const { return end_; }
  /// The refusal of a span without messages; nullopt: all times are selected.
  std::optional<Diagnostic> refusal_of_empty(const Reader& reader) const;

 private:
  explicit Selector(Selection selection) : selection_(std::move(selection)) {}
  Result<void> check_topics(const Reader& reader) const;
  Result<void> find_ticks(Reader& reader);
  Result<void> find_span(Reader& reader);

  Selection selection_;
  std::uint64_t begin_ = 0;
  std::optional<std::uint64_t> end_;
};

/// The log time that a bound means in a file [ns]. A date in a recording of a robot's log is a time of that log. Fails
/// if the recording's clock has no dates.
Result<std::uint64_t> moment_in(const TimeBound& bound, Reader& reader);
/// The same from the beginning of a recording on [s].
Result<double> seconds_in(const TimeBound& bound, Reader& reader);
/// The refusal of a span without messages.
Diagnostic refusal_of_empty(const Reader& reader);

/// The log times of the file's earliest and latest message [ns]; nullopt: there are no messages. From the summary, else
/// by a pass over all messages.
std::optional<std::pair<std::uint64_t, std::uint64_t>> log_times(Reader& reader);

}  // namespace rehearse::mcap
