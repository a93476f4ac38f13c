// The pictures of a campaign's page. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <string>

#include "campaign_findings.h"

namespace rehearse {

/// Sections of a page in HTML, with the cases to which their dots lead.
std::string pictures_of(const Campaign& campaign, const CaseTable& table, const CampaignFindings& findings);

}  // namespace rehearse
