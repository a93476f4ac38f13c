// The report of `audit --coverage` for people.
#pragma once

#include <rehearse/coverage.h>

namespace rehearse::tool {

/// Prints the verdict, the lines that were never executed and the branches that only went one way, with their source
/// where it can be read. `verbose`: all of them, else the first of each.
void tell_coverage(const CoverageReport& report, bool verbose);

}  // namespace rehearse::tool
