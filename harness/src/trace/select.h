// Selection: which messages of a file are meant, by topic, by time and by tick. One rule for all verbs that have
// --topics, --from, --until and --ticks.
//
// Times are on the file's own clock, log time, as `info` shows it: "3.5" is 3.5 s there, in a recording of ours since
// its start, in a bag since 1970. "+3.5" is 3.5 s after the file's first message. A span includes where it begins and
// not where it ends, so that pieces that follow each other have every message once. Ticks include both.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse::mcap {

/// A moment as it is written on a command line.
struct Moment {
  std::uint64_t ns = 0;      // [ns]
  bool after_first = false;  // counted from the file's first message, else from the clock's 0

  bool operator==(const Moment&) const = default;
};

/// From "3.5" or "+3.5" [s]: exact, with at most nine digits behind the point.
Result<Moment> parse_moment(std::string_view text);

/// Numbers of ticks, both included; none: no bound.
struct TickSpan {
  std::optional<std::int64_t> first = std::nullopt;
  std::optional<std::int64_t> last = std::nullopt;

  bool operator==(const TickSpan&) const = default;
};

/// From "10..20", "10..", "..20" or "10".
Result<TickSpan> parse_tick_span(std::string_view text);

/// What isn't said lets everything through.
struct Selection {
  std::vector<std::string> topics = {};          // globs (glob.h); a message is meant if any matches
  std::optional<Moment> from = std::nullopt;     // inclusive
  std::optional<Moment> until = std::nullopt;    // exclusive
  std::optional<TickSpan> ticks = std::nullopt;  // all that was recorded in these ticks; needs a recording of ours

  bool takes_topic(std::string_view topic) const;
  /// Only topics are chosen.
  bool takes_all_times() const { return !from && !until && !ticks; }
};

/// A Selection that knows its file.
class Selector {
 public:
  /// Looks up where ticks and moments are; passes over messages if the file's summary doesn't tell. Fails if a pattern
  /// matches no topic, or if there are no such ticks.
  static Result<Selector> of(Selection selection, Reader& reader);
  /// For messages that come from a pipe: the first that takes() sees is the file's first. Fails if ticks are asked for:
  /// a tick is known when its last message has come.
  static Result<Selector> of_stream(Selection selection);

  bool takes(const Message& message) { return takes_time(message.log_time) && takes_topic(message.channel->topic); }
  bool takes_topic(std::string_view topic) const { return selection_.takes_topic(topic); }
  bool takes_time(std::uint64_t log_time) {
    if (!first_) begin_at(log_time);
    return begin_ <= log_time && (!end_ || log_time < *end_);
  }

  /// The first log time that is meant [ns].
  std::uint64_t begin() const { return begin_; }
  /// The first log time that isn't any more [ns]; none: all that follow are.
  std::optional<std::uint64_t> end() const { return end_; }
  const Selection& selection() const { return selection_; }

 private:
  explicit Selector(Selection selection) : selection_(std::move(selection)) {}
  Result<void> check_topics(const Reader& reader) const;
  Result<void> find_ticks(Reader& reader);
  void begin_at(std::uint64_t first);

  Selection selection_;
  std::optional<std::uint64_t> first_;  // log time of the file's first message, once it is known [ns]
  std::uint64_t begin_ = 0;
  std::optional<std::uint64_t> end_;
};

/// The log time of the file's earliest message [ns]; nullopt: it has none. From the summary, else in a pass.
std::optional<std::uint64_t> first_log_time(Reader& reader);

}  // namespace rehearse::mcap
