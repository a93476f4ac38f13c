// The shares of the variance of results that parameters explain. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <cstddef>
#include <nlohmann/json.hpp>

#include "case_table.h"

namespace rehearse {

/// `passing`: the first-order index of a parameter on passing, and `margin`: that on the margin of which it explains
/// most, with its `expectation`. Null: not known, as of more words than the root of the number of cases.
nlohmann::ordered_json json_of_importance(const Campaign& campaign, const CaseTable& table, std::size_t parameter);

}  // namespace rehearse
