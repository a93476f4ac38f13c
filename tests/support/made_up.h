// Random numbers for statistical tests: the same in every build.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace rehearse::test {

class MadeUp {
 public:
  explicit MadeUp(std::uint64_t seed) : random_(seed) {}

  /// Above 0 and below 1.
  double uniform() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }
  /// Of the standard normal distribution.
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(6.283185307179586 * uniform());
  }

 private:
  std::mt19937_64 random_;
};

/// The probability of at least k successes in n attempts: the exact one-sided test of a share.
inline double binomial_at_least(int k, int n, double share) {
  double sum = 0.0;
  for (int i = k; i <= n; ++i)
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) + i * std::log(share) +
                    (n - i) * std::log1p(-share));
  return sum;
}

}  // namespace rehearse::test
