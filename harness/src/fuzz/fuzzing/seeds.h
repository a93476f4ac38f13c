// Seeds: the inputs of goldens, with which a search begins. Internal.
#pragma once

#include <rehearse/diagnostic.h>

#include <vector>

#include "fuzz_setup.h"
#include "inputs.h"

namespace rehearse {

/// Pieces of the goldens whose names match the plan's pattern, in the order of their names: the values of the joints
/// that the plan states, within their ranges; other inputs are at their starts. Fails if none matches, or one can't be
/// read.
Result<std::vector<Inputs>> seeds_of(const FuzzSetup& setup);

}  // namespace rehearse
