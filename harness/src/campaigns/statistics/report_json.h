// The report of a campaign as JSON. Internal.
#pragma once

#include <string>

#include "campaign_findings.h"

namespace rehearse {

/// The content of report.json, indented.
std::string json_of(const CampaignFindings& findings);

}  // namespace rehearse
