// The values of a campaign's cases. Internal.
#pragma once

#include <rehearse/campaign.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/expression/expression.h"

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

  /// One value for each variation.
  std::vector<std::string> of(std::int64_t number) const;
  /// The values with those of linked parameters computed again. Empty values are nominal.
  std::vector<std::string> with_links(std::vector<std::string> values) const;
  /// Number of cases after which all combinations of grids and all rows of files occurred; 1: there are none. Fails if
  /// there are more than most_cases.
  Result<std::int64_t> round() const;
  /// Fails if the scenario can't be loaded with a bound or a chosen value of a parameter, the others being nominal.
  Result<void> check_bounds() const;

 private:
  CaseValues(const Scenario& scenario, std::uint64_t seed) : scenario_(scenario), seed_(seed) {}

  const std::vector<Variation>& variations() const { return scenario_.variations; }
  Result<void> read_column(const Variation& variation, std::vector<std::string>& rows) const;
  Result<void> parse_link(std::size_t index);
  std::string drawn(std::size_t index, std::int64_t number) const;
  std::vector<std::string> extremes(std::size_t index) const;

  const Scenario scenario_;  // a copy
  const std::uint64_t seed_;
  std::vector<std::vector<std::string>> lists_;  // by variation: values of choices, grids and files
  std::map<std::size_t, Expression> links_;      // by variation
};

}  // namespace rehearse
