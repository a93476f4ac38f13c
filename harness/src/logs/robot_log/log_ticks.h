// LogTicks: the times of the controller's ticks on the log's clock. They are a fixed grid, messages of a topic, or a
// grid whose rate and phase are estimated from the messages of a topic.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace rehearse {

/// Counts durations in bins, so that it needs the same memory for any number of them.
class DurationCounts {
 public:
  /// Bins are narrower than 2^(1 - bits) of a duration. With 17 bits a median has five exact digits, and one counter
  /// needs some MB for durations of all lengths.
  explicit DurationCounts(int bits = 17) : bits_(bits) {}

  void add(std::int64_t duration);  // [ns], at least 0
  /// The mean of the median's bin [ns]; 0: there are no durations.
  std::int64_t median() const { return quantile(0.5); }
  /// The mean of the bin below which at least that share of the durations is [ns]; 0: there are no durations.
  std::int64_t quantile(double share) const;
  /// True if at least 90 % of the durations are between half and one and a half times the median.
  bool is_regular() const;

 private:
  struct Bin {
    std::int64_t count = 0;
    double sum = 0.0;  // [ns]
  };
  int bin_of(std::int64_t duration) const;

  int bits_;                 // of a duration's number that tell its bin
  std::map<int, Bin> bins_;  // by number
  std::int64_t all_ = 0;
};

/// The regular times of messages: origin + n * period.
struct RegularTimes {
  std::int64_t origin = 0;  // [ns]
  double period = 0.0;      // [ns]
  std::int64_t jitter = 0;  // nine of ten messages are within this time of their regular times [ns]
};

/// Fits regular times to messages by least squares. Late messages, which are far off, are left out. `messages` are
/// sorted [ns]; `time_step`: roughly their distance [s]. Fewer than three messages: the period is the time step.
RegularTimes regular_times(const std::vector<std::int64_t>& messages, double time_step);

/// Around a tick: an input in this time may have come before or after it.
struct TickWindow {
  std::int64_t before = 0, after = 0;  // [ns]; 0: none
};

class LogTicks {
 public:
  /// A grid from `start` [ns] on, without end.
  LogTicks(std::int64_t start, double time_step)
      : step_(time_step), start_(start), period_(time_step * 1e9), is_nominal_(true) {}

  /// A tick for each of the times in `messages` [ns], which are sorted, unless it is before `start`. Where messages are
  /// missing there is a tick for each of them, evenly spaced. Ticks are later than the messages by `shift` [ns], which
  /// may be negative, but not before `start`. `skips`: there are no ticks where messages are missing.
  static LogTicks at_messages(const std::vector<std::int64_t>& messages, std::int64_t start, double time_step,
                              std::int64_t shift = 0, bool skips = false);

  /// As at_messages(), for a grid of regular times up to `end` [ns].
  static LogTicks at_regular_times(const RegularTimes& times, std::int64_t shift, std::int64_t start, std::int64_t end,
                                   double time_step);

  /// True: the grid of the first constructor.
  bool is_nominal() const { return is_nominal_; }
  std::int64_t size() const { return messages_.empty() ? size_ : messages_.back().tick + 1; }  // nominal: 0
  /// The time of a tick [ns]; a tick before the first or after the last message is on a grid.
  std::int64_t time(std::int64_t tick) const;
  /// The tick whose time is nearest to `time` [ns]; not before tick 0.
  std::int64_t nearest(std::int64_t time) const;
  double time_step() const { return step_; }  // nominal [s]

  /// True if the tick has its message; every tick of a grid has it.
  bool has_message(std::int64_t tick) const;
  /// Two messages that are each off by a tenth of a step are within it [time steps].
  static constexpr double usual_distance = 0.2;
  /// True if the time since the tick before is so short or so long that a message may be late or missing: it is off by
  /// more than `usual` time steps.
  bool is_irregular(std::int64_t tick, double usual = usual_distance) const;

 private:
  struct Message {
    std::int64_t time;  // [ns]
    std::int64_t tick;
  };
  std::int64_t grid_time(std::int64_t origin, std::int64_t ticks) const;
  /// The first message of this tick or a later one; the tick must not be after the last.
  std::vector<Message>::const_iterator message_from(std::int64_t tick) const;

  bool is_grid() const { return messages_.empty(); }

  double step_;  // [s]
  std::int64_t start_ = 0;
  double period_ = 0.0;          // of a grid [ns]
  std::int64_t grid_start_ = 0;  // of an estimated grid [ns]
  bool is_nominal_ = false;
  bool skips_ = false;             // a long time between two ticks is no irregularity
  std::int64_t size_ = 0;          // of a grid
  std::vector<Message> messages_;  // empty: a grid
};

}  // namespace rehearse
