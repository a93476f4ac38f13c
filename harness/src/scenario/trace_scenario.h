// The scenario of a recording, read from the trace itself: no other file is needed.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

namespace rehearse {

/// Seed and duration are those of the recording, which the command line may have set. Fails if the trace is no
/// recording of Rehearse, has an unknown version, or lacks an attachment.
Result<Scenario> scenario_of(const mcap::Reader& trace);
/// The scenario of a loaded trace.
Result<Scenario> recorded_scenario(const Trace& trace);

}  // namespace rehearse
