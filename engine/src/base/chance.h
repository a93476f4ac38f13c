// Chance: random numbers that depend on a key, a tick and a place, and on nothing else.
#pragma once

#include <cstdint>

namespace rehearse {

class Chance {
 public:
  Chance(std::uint64_t key, std::int64_t tick)
      : base_(mix(key + golden_gamma * static_cast<std::uint64_t>(tick + 1))) {}

  /// Between 0 and 1, both excluded.
  double uniform(std::uint64_t place) const {
    constexpr double spacing = 1.0 / static_cast<double>(1ull << 53);
    return (static_cast<double>(mix(base_ + golden_gamma * (place + 1)) >> 11) + 0.5) * spacing;
  }

 private:
  static constexpr std::uint64_t golden_gamma = 0x9E3779B97F4A7C15u;

  /// SplitMix64's output function: G. L. Steele, D. Lea, C. H. Flood, Fast Splittable Pseudorandom Number Generators,
  /// OOPSLA 2014.
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  std::uint64_t base_;
};

}  // namespace rehearse
