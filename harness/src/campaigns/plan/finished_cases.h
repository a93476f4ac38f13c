// The cases of a campaign that have results. Internal.
#pragma once

#include <rehearse/campaign.h>

#include <cstddef>
#include <vector>

namespace rehearse {

/// The first runs of cases and their second ones that have results.
struct FinishedCases {
  explicit FinishedCases(const Campaign& campaign)
      : first(static_cast<std::size_t>(campaign.options().cases)), again(first.size()) {}
  void take(const CaseResult& result) {
    (result.again ? again : first)[static_cast<std::size_t>(result.number)] = true;
  }

  std::vector<bool> first, again;  // by case
};

}  // namespace rehearse
