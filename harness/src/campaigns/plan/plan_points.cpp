#include "plan_points.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <utility>

#include "base/hashing.h"
#include "base/names.h"

namespace rehearse {
namespace {

constexpr int digits = 32;            // of a direction number, in base 2
constexpr int random_digits = 52;     // of a number between 0 and 1
constexpr std::int64_t no_case = -1;  // for numbers that all cases share

std::uint64_t random_bits(std::uint64_t seed, std::int64_t number, std::string_view name) {
  static_assert(std::endian::native == std::endian::little);
  const std::uint64_t key[2] = {seed, static_cast<std::uint64_t>(number)};
  return hash_bytes(name.data(), name.size(), hash_bytes(key, sizeof key)) >> (64 - random_digits);
}

/// The middle of a part of 2^-52.
double number_of(std::uint64_t bits) {
  return (static_cast<double>(bits) + 0.5) / static_cast<double>(1ull << random_digits);
}

/// A primitive polynomial over the integers modulo 2 and the first direction numbers: of the degree m.size(), with the
/// coefficients between the first and the last as binary digits.
struct Direction {
  std::uint32_t coefficients;
  std::vector<std::uint32_t> m;
};

/// The rows 2 to 21 of the table new-joe-kuo-6.21201 of the paper; the first parameter has no polynomial.
const std::vector<Direction>& directions() {
  static const std::vector<Direction> rows{{0, {1}},
                                           {1, {1, 3}},
                                           {1, {1, 3, 1}},
                                           {2, {1, 1, 1}},
                                           {1, {1, 1, 3, 3}},
                                           {4, {1, 3, 5, 13}},
                                           {2, {1, 1, 5, 5, 17}},
                                           {4, {1, 1, 5, 5, 5}},
                                           {7, {1, 1, 7, 11, 19}},
                                           {11, {1, 1, 5, 1, 1}},
                                           {13, {1, 1, 1, 3, 11}},
                                           {14, {1, 3, 5, 5, 31}},
                                           {1, {1, 3, 3, 9, 7, 49}},
                                           {13, {1, 1, 1, 15, 21, 21}},
                                           {16, {1, 3, 1, 13, 27, 49}},
                                           {19, {1, 1, 1, 15, 7, 5}},
                                           {22, {1, 3, 1, 15, 13, 25}},
                                           {25, {1, 1, 5, 5, 19, 61}},
                                           {1, {1, 3, 7, 11, 23, 15, 103}},
                                           {4, {1, 3, 7, 13, 13, 15, 69}}};
  return rows;
}

/// The direction numbers of a parameter, the first at [0], each with its first binary digit on top.
std::vector<std::uint32_t> direction_numbers(std::size_t parameter) {
  std::vector<std::uint32_t> numbers(digits);
  if (parameter == 0) {
    for (int i = 0; i < digits; ++i) numbers[static_cast<std::size_t>(i)] = 1u << (digits - 1 - i);
    return numbers;
  }
  const Direction& row = directions()[parameter - 1];
  const std::size_t degree = row.m.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i < degree) {
      numbers[i] = row.m[i] << (static_cast<std::size_t>(digits) - 1 - i);
      continue;
    }
    numbers[i] = numbers[i - degree] ^ (numbers[i - degree] >> degree);
    for (std::size_t k = 1; k < degree; ++k)
      if ((row.coefficients >> (degree - 1 - k) & 1u) != 0) numbers[i] ^= numbers[i - k];
  }
  return numbers;
}

/// All numbers below `count` in a random order (R. Durstenfeld, Algorithm 235: Random permutation, Communications of
/// the ACM 7 (1964)).
std::vector<std::uint32_t> random_order(std::uint64_t seed, const std::string& name, std::int64_t count) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t left = order.size(); left > 1; --left) {
    const double random = uniform_number(seed, static_cast<std::int64_t>(left), name + "/order");
    const auto other = std::min(left - 1, static_cast<std::size_t>(random * static_cast<double>(left)));
    std::swap(order[left - 1], order[other]);
  }
  return order;
}

}  // namespace

double uniform_number(std::uint64_t seed, std::int64_t number, std::string_view name) {
  return number_of(random_bits(seed, number, name));
}

PlanPoints::PlanPoints(PlanKind kind, std::uint64_t seed, std::vector<std::string> parameters, std::int64_t cases)
    : kind_(kind), seed_(seed), parameters_(std::move(parameters)), cases_(cases) {
  if (kind_ == PlanKind::sobol) {
    REHEARSE_ASSERT(parameters_.size() <= most_sobol_parameters, "there are direction numbers for all parameters");
    for (std::size_t i = 0; i < parameters_.size(); ++i) table_.push_back(direction_numbers(i));
  }
  if (kind_ == PlanKind::latin_hypercube) {
    REHEARSE_ASSERT(cases >= 0 && cases <= most_latin_cases, "the order of all cases is kept");
    for (const std::string& name : parameters_) table_.push_back(random_order(seed, name, cases));
  }
}

double PlanPoints::at(std::size_t parameter, std::int64_t number) const {
  switch (kind_) {
    case PlanKind::random: break;
    case PlanKind::sobol: return sobol(parameter, number);
    case PlanKind::latin_hypercube: return latin(parameter, number);
  }
  return uniform_number(seed_, number, parameters_[parameter]);
}

double PlanPoints::sobol(std::size_t parameter, std::int64_t number) const {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(digits); ++i)
    if ((number >> i & 1) != 0) bits ^= table_[parameter][i];
  const std::uint64_t shifted = static_cast<std::uint64_t>(bits) << (random_digits - digits);
  return number_of(shifted ^ random_bits(seed_, no_case, parameters_[parameter]));
}

double PlanPoints::latin(std::size_t parameter, std::int64_t number) const {
  const double part = table_[parameter][static_cast<std::size_t>(number)];
  const double place = uniform_number(seed_, number, parameters_[parameter]);
  return std::min((part + place) / static_cast<double>(cases_), 1.0 - std::numeric_limits<double>::epsilon());
}

}  // namespace rehearse
