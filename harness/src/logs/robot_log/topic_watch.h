// TopicWatch: measures how a topic of a log provides the ticks with messages: late, out of order or missing ones.
#pragma once

#include <rehearse/mcap.h>

#include <cstdint>
#include <deque>
#include <optional>

#include "log_replay.h"
#include "log_ticks.h"

namespace rehearse {

/// Counts the spans in which the value at ticks is older than a map allows.
class GapWatch {
 public:
  /// `max_age` [s]: an older value is a gap; nullopt: there are no gaps.
  explicit GapWatch(std::optional<double> max_age);

  /// A tick at that time [s] reads a value of that age [ns]. True: a gap begins.
  bool look(std::int64_t age, double seconds);
  bool is_in_gap() const { return in_gap_; }
  const LogGaps& found() const { return found_; }

 private:
  std::optional<std::int64_t> max_age_;  // [ns]
  bool in_gap_ = false;
  LogGaps found_;
};

/// True if a message may be missing: the last one, of that time [ns], is older than half a period, and the next one is
/// over one and a half periods after it, or not there.
bool misses_message(std::int64_t age, std::int64_t last, std::optional<std::int64_t> next, std::int64_t period);

class TopicWatch {
 public:
  /// `max_age` [s]: see GapWatch. `period` [ns]: of regular messages; 0: they aren't regular.
  explicit TopicWatch(std::optional<double> max_age, std::int64_t period = 0) : gaps_(max_age), period_(period) {}

  /// Adds the time of the next message in the order of the log [ns]. False: it is earlier than the last message, and
  /// isn't used.
  bool came(std::int64_t time);
  /// Rejects the message of that time, which can't be read. No tick may have read it yet.
  void reject(std::int64_t time);
  /// A tick reads the topic; `both_sides`: it also reads the next message.
  enum class Age { none_yet, fresh, held, gap_begins, gap };
  Age look(std::int64_t time, double seconds, bool both_sides);
  /// Messages in that window around a tick may have come before or after it.
  void doubt(const TickWindow& window) { window_ = window; }
  /// True if the last tick may have had another message. One may be missing: the tick is at least half a period after
  /// the last one, and the next one is over one and a half periods after that. Or one is in the window. Messages up to
  /// a period after the tick have to be there.
  bool may_miss() const { return may_miss_; }
  /// Sets all members except names. `start`: the time of tick 0 [ns].
  void report(LogTopicReport& report, std::int64_t start) const;
  /// The time of the current message at the last tick that read the topic [ns].
  std::int64_t current() const { return current_ ? *current_ : 0; }

 private:
  struct Waiting {
    std::int64_t time;
    bool used;
  };

  std::optional<std::int64_t> first_, last_;
  std::int64_t longest_gap_ = 0, longest_gap_at_ = 0;
  std::optional<std::int64_t> current_;
  bool current_used_ = false;
  std::deque<Waiting> waiting_;  // after the current one
  LogTopicReport counts_;
  GapWatch gaps_;
  const std::int64_t period_;  // [ns]
  TickWindow window_;
  bool may_miss_ = false;
};

/// The report as text by name, as stored in a recording.
mcap::StringMap metadata_of(const LogTopicReport& topic);

}  // namespace rehearse
