// A recording as a report is made of it, and what a comparison says of its values. Internal.
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

#include "compare/compare_parts.h"

namespace rehearse {

/// One of the two runs.
struct ReportedRun {
  const Trace& trace;
  TickClock clock;

  explicit ReportedRun(const Trace& of) : trace(of), clock(of) {}
};

/// What a comparison found, value by value.
class JudgedValues {
 public:
  struct Column {
    std::int64_t beyond = 0;
    std::optional<double> tolerance;     // in force
    std::size_t last = ~std::size_t{0};  // the message that was counted last
  };

  explicit JudgedValues(const ReportedRun& golden)
      : clock_(golden.clock), channels_(golden.trace.channels()), columns_(channels_.size()) {}
  /// Its channel, as all channels here, is of the golden.
  void take(const DifferingValue& value);
  /// Tolerances in force, and what is beyond and no value: events.
  void conclude(const Comparison& comparison);

  const Column& of(const TraceChannel& channel, std::size_t column) const;
  /// Pixels that differ by more than is allowed to each; 0: none does.
  std::int64_t pixels(const TraceChannel& channel, std::size_t message) const;
  /// Ticks in which something is beyond tolerance, as [begin, end), at most so many; the nearest are joined.
  std::vector<std::pair<std::int64_t, std::int64_t>> spans(std::size_t most) const;

 private:
  void mark(std::int64_t tick);
  std::size_t index_of(const TraceChannel& channel) const {
    return static_cast<std::size_t>(&channel - channels_.data());
  }

  const TickClock& clock_;
  const std::vector<TraceChannel>& channels_;
  std::vector<std::vector<Column>> columns_;                            // by channel; empty: nothing is known of it
  std::map<std::pair<std::size_t, std::size_t>, std::int64_t> pixels_;  // by channel and message
  std::vector<bool> beyond_;                                            // by tick, from that of the clock's first
};

}  // namespace rehearse
