// Programs, libraries and files of two runs. Internal.
#pragma once

#include <rehearse/compare.h>

#include "compared_traces.h"

namespace rehearse {

/// Compares the provenance of both traces: sets changed_files, same_arithmetic, same_origin, remarks and explanation.
void compare_provenance(const ComparedTraces& traces, Comparison& comparison);

}  // namespace rehearse
