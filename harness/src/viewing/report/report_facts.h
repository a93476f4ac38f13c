// The facts of a run and the call stack as JSON of tools/report/FORMAT.md. Internal.
#pragma once

#include <rehearse/report.h>
#include <rehearse/scenario.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "report_blobs.h"
#include "report_run.h"

namespace rehearse {

struct RunFacts;

/// A sentence about the end of a run; empty: it ended regularly.
std::string outcome_of(const RunFacts& run);

ReportJson json_of(const CallStack& stack);

/// The entries of `control_times`.
ReportJson json_of(const std::vector<ControlTimes>& all);

/// The entry of `runs`. `file`: as the user named it.
ReportJson run_json(const ReportedRun& run, std::string_view role, const std::filesystem::path& file);

/// The time step [s]; for a recording whose scenario can't be read, by its clock.
double time_step_of(const ReportedRun& run, const std::optional<Scenario>& scenario);

}  // namespace rehearse
