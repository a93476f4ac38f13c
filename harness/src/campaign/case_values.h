// The values of a campaign's cases. Internal.
#pragma once

#include <rehearse/campaign.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// A number between 0 and 1, both excluded: the upper 52 bits of XXH3-64 of the name, plus a half, over 2^52. The hash
/// is seeded with XXH3-64 of seed and case, as two little-endian numbers of 64 bits.
double uniform_number(std::uint64_t seed, std::int64_t number, std::string_view name);

/// The quantile of a varied number's distribution: uniform, log_uniform or normal. Always within its bounds.
double quantile_of(const Variation& variation, double probability);

/// Replaces the distribution of a number within its bounds.
void steer(Variation& variation, const SteeredParameter& steered);

class CaseValues {
 public:
  static constexpr std::int64_t most_cases = 100'000'000;

  /// Reads the files of values, and parses linked expressions.
  static Result<std::shared_ptr<const CaseValues>> make(const Scenario& scenario, std::uint64_t seed);
  virtual ~CaseValues() = default;

  /// One value for each variation.
  virtual std::vector<std::string> of(std::int64_t number) const = 0;
  /// The values with those of linked parameters computed again. Empty values are nominal.
  virtual std::vector<std::string> with_links(std::vector<std::string> values) const = 0;
  /// Number of cases after which all combinations of grids and all rows of files occurred; 1: there are none. Fails if
  /// there are more than most_cases.
  virtual Result<std::int64_t> round() const = 0;
  /// Fails if the scenario can't be loaded with a bound or a chosen value of a parameter, the others being nominal.
  virtual Result<void> check_bounds() const = 0;
};

}  // namespace rehearse
