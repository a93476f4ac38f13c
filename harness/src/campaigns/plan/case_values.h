// The values of a campaign's cases. Internal.
#pragma once

#include <rehearse/campaign.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/expression/expression.h"
#include "plan_points.h"

namespace rehearse {

/// The quantile of a varied number's distribution: uniform, log_uniform or normal. Always within its bounds.
double quantile_of(const Variation& variation, double probability);

/// The density of a varied number at a value: uniform, log_uniform or normal, without `integer`. 0 beyond the bounds.
double density_of(const Variation& variation, double value);

/// A distribution that replaces that of a parameter, within its bounds.
struct SteeredVariation {
  Variation variation;
  bool of_logarithm = false;  // the variation is that of the logarithm
};
SteeredVariation steer(const Variation& variation, const SteeredParameter& steered);
double quantile_of(const SteeredVariation& steered, double probability);
double density_of(const SteeredVariation& steered, double value);

/// The distributions of a campaign's parameters.
struct Steering {
  std::vector<SteeredParameter> steered;  // empty: all are those of the scenario
  double own_share = 0.0;                 // of the values of each of them, which are drawn as the scenario states
};

class CaseValues {
 public:
  static constexpr std::int64_t most_cases = 100'000'000;

  /// Reads the files of values, and parses linked expressions. `cases`: their number; 0: round(). Fails if the plan
  /// of the scenario can't have so many parameters or cases.
  static Result<std::shared_ptr<const CaseValues>> make(const Scenario& scenario, std::uint64_t seed,
                                                        std::int64_t cases = 0, const Steering& steering = {});

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
  CaseValues(const Scenario& scenario, std::uint64_t seed, const Steering& steering);

  const std::vector<Variation>& variations() const { return scenario_.variations; }
  Result<void> read_column(const Variation& variation, std::vector<std::string>& rows) const;
  Result<void> parse_link(std::size_t index);
  Result<void> make_points(std::int64_t cases);
  std::string drawn(std::size_t index, std::int64_t number) const;
  std::vector<std::string> extremes(std::size_t index) const;

  const Scenario scenario_;  // a copy
  const std::uint64_t seed_;
  const double own_share_;
  std::vector<std::optional<SteeredVariation>> steered_;  // by variation
  std::vector<std::optional<std::size_t>> place_;         // by variation: among the drawn ones
  std::optional<PlanPoints> points_;
  std::vector<std::vector<std::string>> lists_;  // by variation: values of choices, grids and files
  std::map<std::size_t, Expression> links_;      // by variation
};

}  // namespace rehearse
