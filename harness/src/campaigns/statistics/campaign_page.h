// The report of a campaign as a page and as Markdown. Internal.
#pragma once

#include <rehearse/campaign_report.h>

#include <cstddef>
#include <string>
#include <vector>

#include "campaign_findings.h"

namespace rehearse {

/// The values of two parameters in cells: four equal parts of the range that occurs, or the words of a choice.
struct CellGrid {
  CellGrid(const CaseTable& table, std::size_t a, std::size_t b);
  std::size_t columns = 0, rows = 0;
  std::vector<std::size_t> counts;  // cases with a result, by row (of `b`), then by column (of `a`)
};
/// A cell of a parameter: "0.2 to 0.4", or a word.
std::string cell_text(const CaseTable& table, std::size_t parameter, std::size_t cell);

std::string markdown_of(const CampaignFindings& findings);
std::string page_of(const Campaign& campaign, const CaseTable& table, const CampaignFindings& findings);

}  // namespace rehearse
