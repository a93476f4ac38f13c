// A recording in a report, which may be larger than the memory, and the results of the comparison for its values.
// Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/compare/tick_clock.h"

namespace rehearse {

/// Lowest and highest of the finite values of a series.
struct ValueRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool empty() const { return low > high; }
  void take(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void take(const ValueRange& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
};

/// A summary of all messages of a channel.
struct ChannelSummary {
  std::uint64_t messages = 0;
  std::uint64_t first_time = std::numeric_limits<std::uint64_t>::max();  // [ns]
  std::uint64_t last_time = 0;                                           // [ns]
  std::uint64_t hash = 0;                                                // of times and bytes
  std::vector<ValueRange> ranges = {};                                   // by column

  void take(const TraceChannel& piece);
  bool same_messages(const ChannelSummary& other) const { return messages == other.messages && hash == other.hash; }
};

/// One of the two runs, without its messages.
struct ReportedRun {
  std::filesystem::path file;            // of the recording, or of its reported part
  Trace trace;                           // its tables have all columns, but no rows
  TickClock clock;                       // all ticks
  std::vector<ChannelSummary> channels;  // parallel to trace.channels()

  /// Reads the file once. A damaged file is read up to the damage, and around it.
  static Result<ReportedRun> read(const std::filesystem::path& file);

  /// The index of one of trace.channels().
  std::size_t place_of(const TraceChannel& channel) const {
    return static_cast<std::size_t>(&channel - trace.channels().data());
  }
  const ChannelSummary& of(const TraceChannel& channel) const { return channels[place_of(channel)]; }
};

/// The results of a comparison, value by value.
class JudgedValues {
 public:
  struct Column {
    std::int64_t beyond = 0;
    std::optional<double> tolerance;     // the applied tolerance
    std::size_t last = ~std::size_t{0};  // the message that was counted last
  };

  explicit JudgedValues(const ReportedRun& golden)
      : clock_(golden.clock), channels_(golden.trace.channels()), columns_(channels_.size()) {}
  /// Adds a difference of a comparison in windows. All channels are the golden's.
  void take(const DifferingValue& value);
  /// Sets the applied tolerances, and the events beyond tolerance, which are no values.
  void conclude(const Comparison& comparison);

  /// `place`: the index of the channel in the golden.
  const Column& of(std::size_t place, std::size_t column) const;
  /// Number of pixels that differ by more than the tolerance of a pixel; 0: none.
  std::int64_t pixels(std::size_t place, std::size_t message) const;
  /// Ticks with a difference beyond tolerance, as [begin, end); at most `most` spans, so the nearest are joined.
  std::vector<std::pair<std::int64_t, std::int64_t>> spans(std::size_t most) const;

 private:
  void mark(std::int64_t tick);
  const TickClock& clock_;
  const std::vector<TraceChannel>& channels_;
  std::vector<std::vector<Column>> columns_;                            // by channel; empty: no results for it
  std::map<std::pair<std::size_t, std::size_t>, std::int64_t> pixels_;  // by channel and message
  std::vector<bool> beyond_;                                            // by tick, from that of the clock's first
};

}  // namespace rehearse
