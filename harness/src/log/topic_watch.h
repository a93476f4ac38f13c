// TopicWatch: how well a topic of a log serves the ticks: what came late, out of order or not at all.
#pragma once

#include "log_replay.h"

#include <cstdint>
#include <deque>
#include <optional>
#include <string>

namespace rehearse {

class TopicWatch {
 public:
  /// `max_age` [s]: older than this at a tick is a gap; nullopt: nothing is.
  explicit TopicWatch(std::optional<double> max_age);

  /// A message of that time came next in the order of the log [ns]. False: it is before the one that came last, and
  /// isn't used.
  bool came(std::int64_t time);
  /// A tick looks at the topic; `both_sides`: also at the message behind it.
  enum class Age { none_yet, fresh, held, gap_begins, gap };
  Age look(std::int64_t time, double seconds, bool both_sides);
  /// Fills in what it knows: all but names. `start`: the time of tick 0 [ns].
  void report(LogTopicReport& report, std::int64_t start) const;
  /// The message that is at hand at the last tick looked at [ns].
  std::int64_t current() const { return current_ ? *current_ : 0; }

 private:
  struct Waiting {
    std::int64_t time;
    bool used;
  };

  std::optional<std::int64_t> max_age_;  // [ns]
  std::optional<std::int64_t> first_, last_;
  std::int64_t longest_gap_ = 0, longest_gap_at_ = 0;
  std::optional<std::int64_t> current_;
  bool current_used_ = false;
  std::deque<Waiting> waiting_;  // behind the current one
  LogTopicReport counts_;
  bool in_gap_ = false;
};

}  // namespace rehearse
