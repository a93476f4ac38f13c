// The scenario of a recording, read from the trace itself: no other file is needed.
#pragma once

#include <rehearse/mcap.h>
#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <filesystem>

namespace rehearse {

/// Seed and duration are those of the recording, which the command line may have set. Fails if the trace is no
/// recording of Rehearse, has an unknown version, or lacks an attachment.
Result<Scenario> scenario_of(const mcap::Reader& trace);
/// The scenario of a loaded trace.
Result<Scenario> recorded_scenario(const Trace& trace);

/// The folder that relative paths of controllers' libraries begin at: that of the scenario's file; for the scenario of
/// a recording, which is named TRACE/scenario.yaml, that of the recording.
std::filesystem::path folder_of(const Scenario& scenario);

}  // namespace rehearse
