#include "steering.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace rehearse {
namespace {

constexpr double elite_share = 0.1;
constexpr double weight = 0.9;                 // of the elite's distribution; the rest is that of the round
constexpr double least_share_of_range = 1e-3;  // of the deviation

struct Moments {
  double mean = 0.0, stddev = 0.0;
};

bool is_logarithmic(const Variation& variation) { return variation.distribution == Distribution::log_uniform; }

double range_of(const Variation& variation) {
  return is_logarithmic(variation) ? std::log(variation.high / variation.low) : variation.high - variation.low;
}

/// Of the scenario's distribution, before truncation; of log_uniform those of the logarithm.
Moments own_moments(const Variation& variation) {
  if (variation.distribution == Distribution::normal) return {variation.mean, variation.stddev};
  const double low = is_logarithmic(variation) ? std::log(variation.low) : variation.low;
  return {low + 0.5 * range_of(variation), range_of(variation) / std::sqrt(12.0)};
}

Moments moments_in(const Variation& variation, const std::vector<SteeredParameter>& round) {
  const auto found = std::ranges::find(round, variation.name, &SteeredParameter::name);
  return found == round.end() ? own_moments(variation) : Moments{found->mean, found->stddev};
}

/// The mean of the values, and their widened deviation from another mean.
Moments moments_about(double center, const std::vector<double>& values) {
  const double n = static_cast<double>(values.size());
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += (value - center) * (value - center);
  }
  return {sum / n, std::sqrt(squares / n) * (1.0 + 1.0 / std::sqrt(n))};
}

}  // namespace

bool can_be_steered(const Variation& variation) {
  return variation.distribution <= Distribution::normal && !variation.integer;
}

std::vector<std::size_t> elite_of(const std::vector<double>& margins) {
  std::vector<std::size_t> cases;
  for (std::size_t i = 0; i < margins.size(); ++i)
    if (!std::isnan(margins[i])) cases.push_back(i);
  std::ranges::stable_sort(cases, [&](std::size_t a, std::size_t b) { return margins[a] < margins[b]; });
  const auto share = static_cast<std::size_t>(elite_share * static_cast<double>(cases.size()));
  const auto violating =
      static_cast<std::size_t>(std::ranges::count_if(cases, [&](std::size_t number) { return margins[number] < 0.0; }));
  cases.resize(std::min(cases.size(), std::max({share, least_elite, violating})));
  return cases;
}

SteeredParameter steered_by(const Variation& variation, const std::vector<SteeredParameter>& round,
                            const std::vector<double>& elite) {
  std::vector<double> values = elite;
  if (is_logarithmic(variation))
    for (double& value : values) value = std::log(value);
  const Moments before = moments_in(variation, round), now = moments_about(before.mean, values);
  const double stddev = weight * now.stddev + (1.0 - weight) * before.stddev;
  const double largest = own_moments(variation).stddev, least = least_share_of_range * range_of(variation);
  return {variation.name, weight * now.mean + (1.0 - weight) * before.mean,
          std::max(std::min(stddev, largest), std::min(least, largest))};
}

}  // namespace rehearse
