// The comparison of the fits to two recordings.
#include <rehearse/fit.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification.h"

namespace rehearse {
namespace {

constexpr double false_alarms = 0.05;  // of all numbers together, at most

double variance_of(const FittedNumber& number) {
  // an end of the interval may be at a bound: the farther one counts
  const double half = std::max(number.value - number.low, number.high - number.value);
  return std::pow(half / deviations_of_95_percent, 2);
}

}  // namespace

std::vector<WornNumber> wear(const FitResult& earlier, const FitResult& later) {
  REHEARSE_ASSERT(earlier.numbers.size() == later.numbers.size(), "both fits have the same numbers");
  std::vector<WornNumber> worn;
  for (std::size_t i = 0; i < earlier.numbers.size(); ++i) {
    WornNumber number{earlier.numbers[i], later.numbers[i], 1.0, false};
    const FittedNumber& a = number.earlier;
    const FittedNumber& b = number.later;
    if (a.is_identified() && b.is_identified()) {
      const double distance = std::abs(b.value - a.value) / std::sqrt(variance_of(a) + variance_of(b));
      number.probability = std::isfinite(distance) ? std::erfc(distance / std::sqrt(2.0)) : 1.0;
      number.has_moved = (a.high < b.low || b.high < a.low) &&
                         number.probability < false_alarms / static_cast<double>(earlier.numbers.size());
    }
    worn.push_back(std::move(number));
  }
  return worn;
}

}  // namespace rehearse
