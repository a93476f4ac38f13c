// LogTicks: the times of the controller's ticks on the log's clock. They are a fixed grid, or messages of a topic.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace rehearse {

/// Counts durations in bins that are at most 3 % wide. Needs the same memory for any number of them.
class DurationCounts {
 public:
  void add(std::int64_t duration);  // [ns], at least 0
  /// The mean of the median's bin [ns]; 0: there are no durations.
  std::int64_t median() const;
  /// True if at least 90 % of the durations are between half and one and a half times the median.
  bool is_regular() const;

 private:
  struct Bin {
    std::int64_t count = 0;
    double sum = 0.0;  // [ns]
  };
  std::map<int, Bin> bins_;  // by number
  std::int64_t all_ = 0;
};

class LogTicks {
 public:
  /// A grid from `start` [ns] on, without end.
  LogTicks(std::int64_t start, double time_step) : step_(time_step), start_(start) {}

  /// A tick for each of the times in `messages` [ns], which are sorted, unless it is before `start`. Where messages are
  /// missing there is a tick for each of them, evenly spaced.
  static LogTicks at_messages(const std::vector<std::int64_t>& messages, std::int64_t start, double time_step);

  bool is_grid() const { return messages_.empty(); }
  std::int64_t size() const { return is_grid() ? 0 : messages_.back().tick + 1; }  // of a grid 0
  /// The time of a tick [ns]; a tick before the first or after the last message is on a grid.
  std::int64_t time(std::int64_t tick) const;
  /// The tick whose time is nearest to `time` [ns]; not before tick 0.
  std::int64_t nearest(std::int64_t time) const;
  double time_step() const { return step_; }  // nominal [s]

  /// True if the tick has its message, as every tick of a grid has.
  bool has_message(std::int64_t tick) const;
  /// True if the time since the tick before is so short or so long that a message may be late or missing.
  bool is_irregular(std::int64_t tick) const;

 private:
  struct Message {
    std::int64_t time;  // [ns]
    std::int64_t tick;
  };
  std::int64_t grid_time(std::int64_t origin, std::int64_t ticks) const;
  /// The first message of this tick or a later one; the tick must not be after the last.
  std::vector<Message>::const_iterator message_from(std::int64_t tick) const;

  double step_;  // [s]
  std::int64_t start_ = 0;
  std::vector<Message> messages_;  // empty: a grid
};

}  // namespace rehearse
