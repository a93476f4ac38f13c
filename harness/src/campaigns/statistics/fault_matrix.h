// The matrix of faults by expectations of a campaign that varies `faults`. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <vector>

#include "case_table.h"

namespace rehearse {

/// In the order of the scenario's faults, and of each by the words that vary. Cases without a result aren't counted.
std::vector<FaultRow> fault_matrix(const Campaign& campaign, const CaseTable& table);

}  // namespace rehearse
