// Scenarios and their runs, in the words of the command.
#pragma once

#include <rehearse/check.h>
#include <rehearse/scenario.h>
#include <rehearse/session.h>

#include <string>
#include <vector>

namespace rehearse::tool {

/// Prints what loading changed or doubts about the scenario and its models to stderr; `inspect` shows the notes.
void tell_warnings(const Scenario& scenario);

/// Prints a run's remarks to stderr, and its failure last, once (a failure is among the remarks too).
void tell_remarks(const RunSummary& summary);

/// Prints which expectations of the scenario a run violates, as warnings, with their places.
void tell_violations(const std::vector<ExpectationResult>& results);

/// "SR1 under SR1Minimum, Box": the bodies and what controls them; bodies that never move are left out.
std::string cast_of(const Scenario& scenario);

}  // namespace rehearse::tool
