// The samples of the state that a golden keeps. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <filesystem>
#include <optional>

#include "core/trace/state_rate.h"

namespace rehearse {

/// The rate that a scenario states for the state of its golden; nullopt: all ticks. Channels are kept whole if
/// they are of devices that controllers read, if expectations read them, or if a tolerance allows for time; other
/// inputs of controllers have channels of their own. `run` has all columns.
std::optional<StateRate> state_rate_of(const Scenario& scenario, const Trace& run);

/// The file that becomes the golden: `recording`, if its scenario requests the state of all ticks or isn't readable, or
/// if it has samples already. Else `scratch`, to which the samples are written.
Result<std::filesystem::path> with_state_samples(const std::filesystem::path& recording,
                                                 const std::filesystem::path& scratch);

}  // namespace rehearse
