// Names of series in `expect` and `tolerances` that no run of the scenario can have: mistakes in the scenario, not
// differences of the run. Internal.
#pragma once

#include <rehearse/check.h>

#include <filesystem>
#include <span>
#include <vector>

namespace rehearse {

/// An error for each name that none of the traces has, and that no run of the scenario can have. Patterns with * are no
/// names. A name isn't reported if a run may or may not record it: a variable, a contact, a device that is off.
Diagnostics unknown_series(const Scenario& scenario, std::span<const Trace* const> traces);

/// Fails with these errors after a check that missed a name; the recordings are read only then, and only those that
/// exist. A run that ended early proves nothing.
Result<void> refuse_unknown_series(const Scenario& scenario, const CheckReport& report,
                                   const std::vector<std::filesystem::path>& recordings);

}  // namespace rehearse
