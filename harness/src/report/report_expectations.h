// Expectations of a scenario in a report. Internal.
#pragma once

#include <rehearse/check.h>

#include <cstdint>
#include <vector>

#include "report_blobs.h"

namespace rehearse {

/// The field `expectations` of FORMAT.md. `time_step`: [s]; `begin`, `last`: first and last tick of the run.
ReportJson expectations_json(const std::vector<ExpectationResult>& results, double time_step, std::int64_t begin,
                             std::int64_t last);

}  // namespace rehearse
