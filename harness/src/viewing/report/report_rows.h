// The messages that a report shows: all of them, or in a long run a choice. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "report_run.h"

namespace rehearse {

/// A channel of one or both runs, by its index in each.
struct ChannelPair {
  std::optional<std::size_t> actual, golden;  // at least one
};

/// A channel with the messages that a report shows.
struct ShownChannel {
  ChannelPair pair;
  TraceChannel actual, golden;              // empty where the pair has none
  std::vector<std::size_t> golden_columns;  // for each column of actual: that of golden; no_column: none
  std::vector<std::int64_t> differing;      // for each column of actual: all values of equal times with other bits

  static constexpr std::size_t no_column = ~std::size_t{0};
  const TraceChannel& either() const { return pair.actual ? actual : golden; }
};

/// The times whose messages are all shown.
struct RowFocus {
  std::optional<std::uint64_t> centre;    // the ticks around it are shown, too; none: there is no such time [ns]
  std::vector<std::uint64_t> marks = {};  // ascending [ns]
  std::uint64_t around = 0;               // distance from a mark that is shown, too [ns]
};

/// Chooses and reads the messages of some channels, which may be more than the memory holds. If all have more numbers
/// than `most_cells`, or a channel has more than 3 million, these are chosen: the first and last message, all around
/// the centre, those at marks, the messages with the lowest and highest value of each series within equal stretches of
/// time, the first that differs of each series, and between these one message in equal steps. Of both runs, messages of
/// the same times are chosen.
class ShownRows {
 public:
  /// `golden` may be null. `pairs`: the channels to read, without columns for pictures.
  ShownRows(const ReportedRun& actual, const ReportedRun* golden, std::vector<ChannelPair> pairs, RowFocus focus,
            std::uint64_t most_cells);

  /// False: all messages are shown.
  bool is_thinned() const { return smallest_share_ < 1.0; }
  /// True if more would be shown with a higher `most_cells`.
  bool is_limited() const { return is_limited_; }
  /// The length of the span around the centre in which all messages are shown [s].
  double whole_span() const { return 2.0 * static_cast<double>(half_span_) / 1e9; }

  /// Calls `take` with each of the pairs, in their order. Reads both files once, and once more for a number of pairs
  /// whose numbers take about 16 MB. Fails if a file can't be read.
  Result<void> for_each(const std::function<void(const ShownChannel&)>& take);

 private:
  /// The choice of one pair.
  struct Choice {
    double share = 1.0;                     // of the numbers; 1: all messages are shown
    std::uint64_t step = 1;                 // one message in each step of this length [ns]
    std::uint64_t stretch = 0;              // lowest and highest values in each stretch of this length [ns]; 0: of none
    std::vector<std::uint64_t> times = {};  // messages with lowest and highest values, ascending [ns]
  };
  struct Reading;
  class ExtremesFinder;

  const ReportedRun* run(std::size_t index) const { return index == 0 ? &actual_ : golden_; }
  static std::optional<std::size_t> place_in(const ChannelPair& pair, std::size_t index) {
    return index == 0 ? pair.actual : pair.golden;
  }
  bool is_equal(const ChannelPair& pair) const;
  /// The channel's index in a run; nullopt: the run doesn't have it, or it is the golden's and equals the other.
  std::optional<std::size_t> read_place(const ChannelPair& pair, std::size_t index) const {
    return index == 1 && is_equal(pair) ? std::nullopt : place_in(pair, index);
  }
  std::uint64_t cells_of(const ChannelPair& pair) const;
  void plan(std::size_t pair, double share);
  Result<void> find_extremes();
  bool is_focused(std::uint64_t time) const;
  void choose(const TraceChannel& table, std::size_t pair, std::size_t run, Reading& reading,
              std::vector<std::size_t>& chosen) const;
  void read(std::span<const std::size_t> group, const std::function<void(const ShownChannel&)>& take) const;

  const ReportedRun& actual_;
  const ReportedRun* golden_;
  const std::vector<ChannelPair> pairs_;
  const RowFocus focus_;
  std::uint64_t first_time_ = 0, last_time_ = 0;  // of all channels [ns]
  double smallest_share_ = 1.0;
  bool is_limited_ = false;
  std::uint64_t half_span_ = 0;  // [ns]
  std::vector<Choice> choices_;  // parallel to pairs_
};

}  // namespace rehearse
