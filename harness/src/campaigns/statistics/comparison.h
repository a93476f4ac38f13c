// Two campaigns over the same cases. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include "campaign_findings.h"
#include "case_table.h"

namespace rehearse {

PairedCases paired_cases(const CaseTable& now, const CaseTable& before);

/// The cases that flipped, and the difference of the shares that pass. The summary has pairs.
CampaignChange change_between(const CaseTable& before, const CaseTable& now, const CampaignSummary& summary);

/// Fails if the plans differ: their cases can't be paired. If a margin is claimed, also if the work on one of the
/// campaigns ended with a failure.
Result<void> check_comparable(const Campaign& now, const Campaign& before, bool claims_margin);

}  // namespace rehearse
