// The verdict of a check: the part that changed, and everything else that its levels found. Internal.
#pragma once

#include "check_levels.h"

namespace rehearse {

/// Sets the verdict that names the part that changed.
void blame(Check& check);
/// Reports a changed time step. No tick is compared, but the run may become the next golden, so its expectations are
/// judged.
Result<void> tell_time_step(Check& check, const Divergence& change);
/// Reports a changed duration. The runs were compared up to the end of the shorter one.
void tell_duration(Check& check, const Divergence& change, const Trace& fresh);
/// Tests whether a run within tolerance repeats itself. Tolerances allow for changes. If nothing changed, or if a run
/// doesn't repeat itself, different bits are chance, and a golden that is met by chance proves nothing.
Result<void> test_reproduction(Check& check);
/// Adds the expectations to the verdict. A run that is within tolerance, or was not compared, may violate them.
void judge_by_expectations(Check& check, const Trace& fresh);
/// True for a run that ended before a tick was recorded, as by a crash in initialize(): there is nothing to compare.
bool ended_before_its_first_tick(const RunSummary& run);
/// Sets the verdict on such a run: why it ended, and nothing else. `closed`: the state of that level.
void tell_early_end(CheckReport& report, const std::filesystem::path& actual, LevelState closed);
/// Leads the verdict on a run that differs or is wrong with the first command that isn't finite.
void tell_odd_command(CheckReport& report);

}  // namespace rehearse
