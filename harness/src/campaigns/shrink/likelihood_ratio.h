// The probability of a failure from cases of steered distributions. Internal.
#pragma once

#include <rehearse/scenario.h>
#include <rehearse/shrink.h>

#include <cstdint>
#include <vector>

#include "campaigns/plan/case_values.h"

namespace rehearse {

/// The likelihood ratio of a case: the density of its values in the scenario's own distributions, over that with which
/// they were drawn. Each value is drawn from its own distribution with the probability `own_share`, which must be above
/// 0, else from the steered one. `own`, `steered`: of the parameters that are steered; `values`: of these in the case.
double likelihood_ratio(const std::vector<Variation>& own, const std::vector<SteeredVariation>& steered,
                        const std::vector<double>& values, double own_share);

/// The probability of a violation: the mean over all cases of the likelihood ratio of those that violate, and 0 of the
/// others. Its interval, with 95 % confidence, is the normal one of the logarithm; without a violation it goes from 0
/// to the largest probability of which so many cases show none in one of 40 campaigns. `ratios`: of the cases that
/// violate, each at most 1 / `least_share`.
FailureProbability failure_probability(const std::vector<double>& ratios, std::int64_t cases, double least_share);

}  // namespace rehearse
