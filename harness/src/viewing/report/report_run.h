// A recording in a report, and the results of the comparison for its values. Internal.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/compare/tick_clock.h"

namespace rehearse {

/// One of the two runs.
struct ReportedRun {
  const Trace& trace;
  TickClock clock;

  explicit ReportedRun(const Trace& of) : trace(of), clock(of) {}
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
  /// Adds a difference. All channels are the golden's.
  void take(const DifferingValue& value);
  /// Sets the applied tolerances, and the events beyond tolerance, which are no values.
  void conclude(const Comparison& comparison);

  const Column& of(const TraceChannel& channel, std::size_t column) const;
  /// Number of pixels that differ by more than the tolerance of a pixel; 0: none.
  std::int64_t pixels(const TraceChannel& channel, std::size_t message) const;
  /// Ticks with a difference beyond tolerance, as [begin, end); at most `most` spans, so the nearest are joined.
  std::vector<std::pair<std::int64_t, std::int64_t>> spans(std::size_t most) const;

 private:
  void mark(std::int64_t tick);
  std::size_t index_of(const TraceChannel& channel) const {
    return static_cast<std::size_t>(&channel - channels_.data());
  }

  const TickClock& clock_;
  const std::vector<TraceChannel>& channels_;
  std::vector<std::vector<Column>> columns_;                            // by channel; empty: no results for it
  std::map<std::pair<std::size_t, std::size_t>, std::int64_t> pixels_;  // by channel and message
  std::vector<bool> beyond_;                                            // by tick, from that of the clock's first
};

}  // namespace rehearse
