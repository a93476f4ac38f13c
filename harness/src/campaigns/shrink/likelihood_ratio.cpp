#include "likelihood_ratio.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstddef>

#include "campaigns/statistics/binomial.h"

namespace rehearse {

namespace {

/// The largest weight that is taken into account, over the largest that occurred: few cases don't show it.
constexpr double larger_than_seen = 3.0;
/// The least number of violations, by their weights: of as many with equal weights the sum is as uncertain (L. Kish,
/// Survey Sampling, 1965). The weights of fewer say too little of those that didn't occur.
constexpr double enough = 10.0;

}  // namespace

double likelihood_ratio(const std::vector<Variation>& own, const std::vector<SteeredVariation>& steered,
                        const std::vector<double>& values, double own_share) {
  double ratio = 1.0;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double steered_over_own = density_of(steered[i], values[i]) / density_of(own[i], values[i]);
    ratio /= own_share + (1.0 - own_share) * steered_over_own;
  }
  return ratio;
}

FailureProbability failure_probability(const std::vector<double>& ratios, std::int64_t cases, double least_share) {
  constexpr double tail = 0.025;
  const double n = static_cast<double>(cases);
  FailureProbability found;
  found.cases = cases;
  found.violations = static_cast<std::int64_t>(ratios.size());
  double sum = 0.0, squares = 0.0;
  for (const double ratio : ratios) {
    sum += ratio;
    squares += ratio * ratio;
  }
  found.estimate = sum / n;
  found.has_enough_violations = sum * sum >= enough * squares && !ratios.empty();
  if (!found.has_enough_violations) {
    // a violation of probability p has at least the probability least_share * p in each case
    const double most =
        found.violations == cases ? 1.0 : binomial_upper_bound(static_cast<double>(found.violations), n, tail);
    found.interval = {0.0, std::min(1.0, most / least_share)};
    return found;
  }
  const double largest = larger_than_seen * *std::ranges::max_element(ratios);
  const auto quantile = [n](double sum, double squares, double share) {
    return boost::math::gamma_p_inv(sum * sum / squares, share) * squares / sum / n;
  };
  found.interval = {quantile(sum, squares, tail),
                    std::min(1.0, quantile(sum + largest, squares + largest * largest, 1.0 - tail))};
  return found;
}

FailureProbability failure_probability(const std::vector<Variation>& variations, const Steering& steering,
                                       const std::vector<std::vector<double>>& values,
                                       const std::vector<double>& margins) {
  std::vector<Variation> own;
  std::vector<SteeredVariation> steered;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < variations.size(); ++i) {
    const auto found = std::ranges::find(steering.steered, variations[i].name, &SteeredParameter::name);
    if (found == steering.steered.end()) continue;
    indices.push_back(i);
    own.push_back(variations[i]);
    steered.push_back(steer(variations[i], *found));
  }
  std::vector<double> ratios;
  for (std::size_t number = 0; number < margins.size(); ++number) {
    if (!(margins[number] < 0.0)) continue;
    std::vector<double> of_case;
    for (const std::size_t i : indices) of_case.push_back(values[i][number]);
    ratios.push_back(likelihood_ratio(own, steered, of_case, steering.own_share));
  }
  const double least_share_of_density = std::pow(steering.own_share, static_cast<double>(own.size()));
  return failure_probability(ratios, static_cast<std::int64_t>(margins.size()), least_share_of_density);
}

}  // namespace rehearse
