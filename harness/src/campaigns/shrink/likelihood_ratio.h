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
/// others. Its interval, with 95 % confidence, is that of a sum of weighted Poisson counts: M. P. Fay, E. J. Feuer,
/// Confidence Intervals for Directly Standardized Rates: a Method Based on the Gamma Distribution, Statistics in
/// Medicine 16 (1997), pp. 791-801, with three times the largest ratio of a violation as the largest weight, because a
/// larger one may not have occurred. With fewer than ten violations, by their weights, it goes from 0 to the largest
/// probability of which so many cases show no more violations in one of 40 campaigns. `ratios`: of the cases that
/// violate, each at most 1 / `least_share`.
///
/// The interval holds for the failures that the steered distributions reach. If a failure has another part, which no
/// case shows, the estimate lacks its probability.
FailureProbability failure_probability(const std::vector<double>& ratios, std::int64_t cases, double least_share);

/// Likewise, of cases whose steered values are drawn from `steering`. `values`: by variation, by case; `margins`: of
/// the expectation, by case; below 0: violated; NaN: none.
FailureProbability failure_probability(const std::vector<Variation>& variations, const Steering& steering,
                                       const std::vector<std::vector<double>>& values,
                                       const std::vector<double>& margins);

}  // namespace rehearse
