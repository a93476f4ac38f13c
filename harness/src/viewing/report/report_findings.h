// The differences of two runs, and the expectations of a scenario, in a report. Internal.
#pragma once

#include <rehearse/check.h>
#include <rehearse/compare.h>
#include <rehearse/trace.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "report_blobs.h"

namespace rehearse {

/// The differences by tick: for each channel the first beyond tolerance, and the first in any bit.
struct Places {
  std::vector<std::pair<Divergence, bool>> all;  // true: it is beyond tolerance
  std::optional<std::size_t> first;

  /// `told`: the first difference by a more precise judgement; null: none.
  Places(const Comparison& comparison, const Divergence* told);
};

/// The field `divergences` of FORMAT.md.
ReportJson places_json(const Places& places, const Trace& golden, const Trace& actual);

/// The series with the worst difference of each channel, by multiples of the tolerance.
ReportJson worst_json(const Comparison& comparison, const Trace& golden, const Trace& actual);

/// The field `expectations` of FORMAT.md. `time_step`: [s]; `begin`, `last`: first and last tick of the run.
ReportJson expectations_json(const std::vector<ExpectationResult>& results, double time_step, std::int64_t begin,
                             std::int64_t last);

}  // namespace rehearse
