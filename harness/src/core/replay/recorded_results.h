// RecordedResults: the results of control() in a recording, compared with those of a replay. They are judged as in a
// comparison of recordings: as events, which begin and end, and may be early or late by the ticks of a rule.
#pragma once

#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/compare/event_sequences.h"

namespace rehearse {

class RecordedResults {
 public:
  /// `fields`: the fields of the rows, which must outlive this.
  RecordedResults(const std::vector<OutputField>& fields, const std::vector<ToleranceRule>& rules, double time_step);

  /// Takes the results of a tick. `recorded`: by controller.
  void take(std::int64_t tick, const std::vector<std::uint64_t>& row, const std::vector<bool>& recorded);
  /// True if a result differs in this tick. The ticks of successive calls must not decrease.
  bool differ_at(std::int64_t tick);
  /// The number of such ticks.
  std::int64_t ticks_different() const { return ticks_different_; }
  /// The differences. `last_tick`: that was taken.
  std::vector<JudgedEvent> judge(std::int64_t last_tick) const;

 private:
  struct OfController {
    std::size_t word;  // of the row
    int allowed;       // how early or late an event may be [ticks]
    EventSequence sequence = {};
  };

  const std::vector<OutputField>& fields_;
  const double time_step_;                                    // [s]
  std::vector<OfController> results_;                         // by controller
  std::vector<std::pair<std::int64_t, std::int64_t>> spans_;  // first and last of successive ticks that differ
  std::size_t span_ = 0;                                      // of differ_at()
  std::int64_t ticks_different_ = 0;
};

}  // namespace rehearse
