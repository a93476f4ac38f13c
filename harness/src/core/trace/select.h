// Selection: the messages of a file to use, by topic, by time and by tick. All verbs with --topics, --from, --until and
// --ticks share this rule.
//
// Times are on the file's own clock, log time, as `info` shows it: "3.5" is 3.5 s on this clock, in a recording of
// Rehearse since its start, in a bag since 1970. "+3.5" is 3.5 s after the file's first message. A span includes its
// beginning and excludes its end, so that consecutive pieces contain every message once. A span of ticks includes both.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

/// A time as written on a command line.
struct TimeBound {
  std::uint64_t ns = 0;      // [ns]
  bool after_first = false;  // counted from the file's first message, else from the clock's 0

  bool operator==(const TimeBound&) const = default;
};

/// From "3.5" or "+3.5" [s]: exact, with at most nine digits after the point.
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
  /// matches no topic, or if the file has none of the ticks.
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

 private:
  explicit Selector(Selection selection) : selection_(std::move(selection)) {}
  Result<void> check_topics(const Reader& reader) const;
  Result<void> find_ticks(Reader& reader);
  void begin_at(std::uint64_t first);

  Selection selection_;
  std::uint64_t begin_ = 0;
  std::optional<std::uint64_t> end_;
};

/// The log time of the file's earliest message [ns]; nullopt: there are no messages. From the summary, else by a pass
/// over all messages.
std::optional<std::uint64_t> first_log_time(Reader& reader);

}  // namespace rehearse::mcap
