// RecordedResults: the results of control() in a recording, compared with those of a replay. With tolerances they are
// judged as in a comparison of recordings: as events, which begin and end, and may be early or late.
#pragma once

#include <rehearse/compare.h>
#include <rehearse/replay.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/compare/event_sequences.h"

namespace rehearse {

class RecordedResults {
 public:
  using OnDifference = std::function<void(Divergence&&)>;

  /// `fields`: the fields of the rows, which must outlive this.
  RecordedResults(const std::vector<OutputField>& fields, const ReplayOptions& options, double time_step);

  /// Compares the results of a tick. `recorded`: by controller. Calls `differs` for each difference of a controller to
  /// which no tolerance applies; the caller fills in tick and time. judge() returns those of the others.
  void compare(std::int64_t tick, const std::vector<std::uint64_t>& row, const std::vector<bool>& recorded,
               const OnDifference& differs);
  /// True if a result that judge() judges differs in this tick. The ticks of successive calls must not decrease.
  bool differ_at(std::int64_t tick);
  /// The number of such ticks.
  std::int64_t ticks_different() const { return ticks_different_; }
  /// The differences by tolerances. `last_tick`: that was compared.
  std::vector<JudgedEvent> judge(std::int64_t last_tick) const;

 private:
  struct OfController {
    std::size_t word;            // of the row
    std::optional<int> allowed;  // how early or late an event may be [ticks]; none: no tolerance applies
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
