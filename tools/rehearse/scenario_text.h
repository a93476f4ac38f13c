// Text about scenarios and their runs, for several verbs.
#pragma once

#include <rehearse/check.h>
#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <string>
#include <vector>

namespace rehearse::tool {

/// Prints repairs and warnings about the scenario and its models to stderr; `inspect` prints the notes.
void tell_warnings(const Scenario& scenario);

/// Prints a run's remarks to stderr, and its failure last, once (a failure is among the remarks too).
void tell_remarks(const RunSummary& summary);

/// Prints the expectations of the scenario that a run violates, with their places: as warnings, or as errors those with
/// one of the mistakes.
void tell_violations(const std::vector<ExpectationResult>& results, const Diagnostics& mistakes);

/// "SR1 under SR1Minimum, Box": the bodies and their controllers; bodies that never move are left out.
std::string cast_of(const Scenario& scenario);

}  // namespace rehearse::tool
