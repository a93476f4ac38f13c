// The shares of the variance of results that parameters explain. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <cstddef>
#include <optional>

#include "campaign_findings.h"

namespace rehearse {

/// The first-order index of a parameter on passing. None: unknown, as of more words than the root of the number of
/// cases.
std::optional<FirstOrderIndex> importance_of_passing(const CaseTable& table, std::size_t parameter);
/// Its largest first-order index on the margin of an expectation.
std::optional<IndexOfMargin> importance_of_margin(const Campaign& campaign, const CaseTable& table,
                                                  std::size_t parameter);

}  // namespace rehearse
