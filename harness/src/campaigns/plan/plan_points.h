// The random numbers of a campaign's plan. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/scenario/campaign_claims.h"

namespace rehearse {

/// A number between 0 and 1, both excluded: the upper 52 bits of XXH3-64 of the name, plus a half, over 2^52. The hash
/// is seeded with XXH3-64 of seed and case, as two little-endian numbers of 64 bits.
double uniform_number(std::uint64_t seed, std::int64_t number, std::string_view name);

/// The numbers from which the values of drawn parameters are made, each between 0 and 1, both excluded.
///
/// random: uniform_number() of the seed, the case and the parameter's name.
///
/// sobol: I. M. Sobol', On the distribution of points in a cube and the approximate evaluation of integrals, USSR
/// Computational Mathematics and Mathematical Physics 7 (1967), with the direction numbers of S. Joe, F. Y. Kuo,
/// Constructing Sobol sequences with better two-dimensional projections, SIAM Journal on Scientific Computing 30
/// (2008). The bits of a parameter are shifted (exclusive or) by those of a random number of the seed and its name.
/// Each 2^k cases from a multiple of 2^k on have one in each of 2^k equal parts of each parameter. A case doesn't
/// depend on the number of cases.
///
/// latin_hypercube: M. D. McKay, R. J. Beckman, W. J. Conover, A Comparison of Three Methods for Selecting Values of
/// Input Variables in the Analysis of Output from a Computer Code, Technometrics 21 (1979). Each of as many equal parts
/// of each parameter as there are cases has one case, at a random place in it.
class PlanPoints {
 public:
  static constexpr std::size_t most_sobol_parameters = 21;
  static constexpr std::int64_t most_latin_cases = 1'000'000;

  /// `parameters`: the names of those that are drawn, at most most_sobol_parameters with sobol. `cases`: of the plan,
  /// at most most_latin_cases with latin_hypercube.
  PlanPoints(PlanKind kind, std::uint64_t seed, std::vector<std::string> parameters, std::int64_t cases);

  /// `parameter`: its place among the drawn ones.
  double at(std::size_t parameter, std::int64_t number) const;

 private:
  double sobol(std::size_t parameter, std::int64_t number) const;
  double latin(std::size_t parameter, std::int64_t number) const;

  const PlanKind kind_;
  const std::uint64_t seed_;
  const std::vector<std::string> parameters_;
  const std::int64_t cases_;
  std::vector<std::vector<std::uint32_t>> table_;  // by parameter: direction numbers, or the part of each case
};

}  // namespace rehearse
