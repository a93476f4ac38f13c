#include "likelihood_ratio.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/scenario/normal_quantile.h"

namespace rehearse {

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
  if (ratios.empty()) {
    // a violation of probability p has at least the probability least_share * p in each case
    found.interval = {0.0, std::min(1.0, (1.0 - std::pow(tail, 1.0 / n)) / least_share)};
    return found;
  }
  double sum = 0.0, squares = 0.0;
  for (const double ratio : ratios) {
    sum += ratio;
    squares += ratio * ratio;
  }
  found.estimate = sum / n;
  const double variance = std::max(0.0, squares / n - found.estimate * found.estimate) / n;
  const double reach = std::exp(normal_quantile(1.0 - tail) * std::sqrt(variance) / found.estimate);
  found.interval = {found.estimate / reach, std::min(1.0, found.estimate * reach)};
  return found;
}

}  // namespace rehearse
