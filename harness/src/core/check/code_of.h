// The codes of verdicts that several kinds of checks have. Internal.
#pragma once

#include <rehearse/check.h>

#include <algorithm>
#include <vector>

namespace rehearse {

/// The code of judged expectations.
inline VerdictCode code_of(const std::vector<ExpectationResult>& results) {
  if (!first_violation(results)) return VerdictCode::expectations_hold;
  const bool any_violated =
      std::ranges::any_of(results, [](const ExpectationResult& result) { return !result.holds && !result.undecided; });
  return any_violated ? VerdictCode::expectations_violated : VerdictCode::expectations_undecided;
}

/// The code of a run that didn't come to its end.
inline VerdictCode code_of_failure(const CheckReport& report) {
  return report.run && report.run->end == RunEnding::exploded ? VerdictCode::simulation_exploded
                                                              : VerdictCode::controller_failed;
}

}  // namespace rehearse
