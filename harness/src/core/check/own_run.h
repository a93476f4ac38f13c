// Runs that a verdict rests on. Each begins in a process that has run no controller, if this process has own processes
// (core/guard/own_process.h). Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/replay.h>
#include <rehearse/run_options.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace rehearse {

Result<RunSummary> own_run(const std::function<Result<RunSummary>()>& run);
Result<ResumedRun> own_run(const std::function<Result<ResumedRun>()>& run);

/// A run that has no result.
Result<void> own_run(const std::function<Result<void>()>& run);

/// The function, whose runs then begin in such processes, too: a process that has drawn can't fork one that draws.
RunPlant own_plant(RunPlant run_plant);

/// As replay(). The callbacks of `options` are called in the other process.
Result<ReplayReport> own_replay(const std::filesystem::path& recording, const ReplayOptions& options);

/// A hash of the outputs of each tick of a replay.
Result<std::vector<std::uint64_t>> replayed_outputs(const std::filesystem::path& recording, ReplayOptions options);

}  // namespace rehearse
