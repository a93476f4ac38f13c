// Two campaigns over the same cases. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <nlohmann/json.hpp>

#include "case_table.h"

namespace rehearse {

PairedCases paired_cases(const CaseTable& now, const CaseTable& before);

/// The cases that flipped, and the difference of the shares that pass. The summary has pairs.
nlohmann::ordered_json json_of_change(const CaseTable& now, const CaseTable& before, const CampaignSummary& summary);

/// The claim, its answer and the interval that decides it; null: nothing is claimed.
nlohmann::ordered_json json_of_non_inferiority(const CampaignSummary& summary);

/// Fails if the plans differ: their cases can't be paired. If a margin is claimed, also if the work on one of the
/// campaigns ended with a failure.
Result<void> check_comparable(const Campaign& now, const Campaign& before, bool claims_margin);

}  // namespace rehearse
