// A run in a process of its own. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <filesystem>
#include <string>

#include "case_run.h"

namespace rehearse {

/// Runs a scenario with this text. `file`: the place to which its paths are relative. `trace`: the file of its
/// recording; empty: it is not kept. Fails if a signal interrupts it.
Result<CaseRun> run_alone(const Campaign& campaign, const std::string& text, const std::filesystem::path& file,
                          const std::filesystem::path& trace, const Simulation& simulation);

}  // namespace rehearse
