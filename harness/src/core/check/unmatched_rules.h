// Remarks on tolerances that apply to nothing in a golden. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/trace.h>

#include <string>
#include <vector>

#include "proof.h"

namespace rehearse {

/// A remark for each tolerance that applies to nothing in the golden. Its names are read from the whole golden, so the
/// answer is kept: a certificate states the rules, and those of them that apply to nothing.
Result<std::vector<std::string>> unmatched_rule_remarks(const std::vector<ToleranceRule>& rules, const Trace& golden,
                                                        const Certificates& answers);

}  // namespace rehearse
