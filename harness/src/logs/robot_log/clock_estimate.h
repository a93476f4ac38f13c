// ClockEstimate: the offset and the drift of a topic's stamps from the log's clock, from the delays of all messages,
// log time minus stamp.
//
// They are those of the line below the delays that is nearest to their mean: an edge of their lower convex hull.
// Messages are divided into blocks. A block whose smallest delay is far below those of the others has a wrong stamp; it
// is left out. If a clock steps, each side of the step has a line of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "log_replay.h"

namespace rehearse {

/// Collects (stamp, log time) of messages in the order of log time. Needs the same memory for any number of them.
class ClockEstimate {
 public:
  void add(std::int64_t stamp, std::int64_t log_time);

  /// One for each span between steps of a clock, in the order of the log. Clocks that don't step, and have
  /// delays of 0 to 1 s, agree: then offset and drift are 0.
  std::vector<LogClockReport> report() const;

 private:
  struct Point {
    double x, y;  // log time and delay less those of the first message [ns]
  };
  /// Successive messages.
  struct Block {
    std::int64_t first_stamp = 0;  // [ns]
    std::int64_t count = 0;
    double first_x = 0.0, sum_x = 0.0;
    std::vector<Point> hull;  // the lower convex hull

    void add(const Point& point);
    /// The point with the smallest delay against a line of that slope, and this delay.
    std::pair<Point, double> lowest(double slope) const;
  };
  using Blocks = std::span<const Block>;
  void merge_pairs();
  /// The median of the slopes between two blocks that are at most so many blocks apart.
  static double usual_slope(Blocks blocks, std::size_t reach);
  /// The numbers of the blocks with which the delay begins to be another one for good.
  static std::vector<std::size_t> steps(Blocks blocks);
  /// Without the blocks whose smallest delay is far below the others'.
  static std::vector<Block> plausible(Blocks blocks);
  /// The slope and the value at x = 0 of the line.
  static std::pair<double, double> line(Blocks blocks);
  LogClockReport report_of(Blocks blocks, bool may_agree) const;

  static constexpr std::size_t most_blocks = 128;
  std::int64_t first_time_ = 0, first_delay_ = 0;  // [ns]
  std::int64_t block_size_ = 1;                    // [messages]
  std::vector<Block> blocks_;
};

}  // namespace rehearse
