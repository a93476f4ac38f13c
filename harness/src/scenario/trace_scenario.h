// The scenario that a trace was recorded from, out of the trace itself: no other file is needed.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

namespace rehearse {

/// Seed and duration are those of the recording, which the command line may have set. Fails if the trace is no
/// recording of ours, is of a version that isn't known here, or lacks an attachment.
Result<Scenario> scenario_of(const mcap::Reader& trace);
/// The same of a trace that was loaded.
Result<Scenario> recorded_scenario(const Trace& trace);

}  // namespace rehearse
