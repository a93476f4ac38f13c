// The report of a campaign as a page and as Markdown. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <string>

#include "campaign_findings.h"

namespace rehearse {

std::string markdown_of(const CampaignFindings& findings);
std::string page_of(const Campaign& campaign, const CaseTable& table, const CampaignFindings& findings);

}  // namespace rehearse
