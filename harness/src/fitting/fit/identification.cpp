#include "identification.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace rehearse {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double share_of_bounds = 0.5;  // an interval that is wider decides nothing
constexpr double related = 0.95;
/// Eigenvalues of the curvature, scaled to a diagonal of ones, below this decide nothing: the effects of these numbers
/// are correlated by more than 0.9999, and a model that isn't exact can't separate them.
constexpr double no_curvature = 1e-4;
constexpr double part_of_direction = 1e-3;  // a number whose square in a unit vector is smaller isn't in its direction

struct Excitation {
  std::string_view key, motion;
};
/// By the last key of a path.
constexpr Excitation excitations[] = {
    {"coulomb", "motion at several speeds, in both directions"},
    {"stiction", "slow motion that stops and begins again"},
    {"stribeck", "slow motion that stops and begins again"},
    {"damping", "motion at several speeds, the fastest that the joint allows"},
    {"armature", "quick changes of velocity"},
    {"delay", "commands that change quickly, as steps"},
    {"bandwidth", "commands that change quickly, as steps"},
    {"position_gain", "commanded displacements that the joint doesn't reach at once"},
    {"velocity_gain", "commanded velocities that the joint doesn't reach at once"},
    {"efficiency", "motion under load, up and down"},
    {"backlash", "efforts that change their sign"},
    {"effort", "commands beyond the limit"},
    {"velocity", "commands beyond the limit"},
    {"stall_effort", "large efforts at several speeds"},
    {"no_load_velocity", "large efforts at high speeds"},
    {"mass", "motion that accelerates or lifts the link; none, if it is fixed to the world"},
    {"friction", "contacts that slide"},
};

std::string advice_for(const std::string& path) {
  std::string key = path.substr(path.rfind('.') + 1);
  key = key.substr(0, key.find('['));
  for (const Excitation& one : excitations)
    if (one.key == key) return std::string(one.motion);
  return "motion in which it changes what is measured";
}

/// The eigenvectors of the scaled curvature, and what follows from them for each number.
class Directions {
 public:
  explicit Directions(const MatrixXd& curvature) : scale_(curvature.diagonal().cwiseMax(0.0).cwiseSqrt()) {
    for (Index i = 0; i < scale_.size(); ++i)
      if (scale_[i] > 0.0) seen_.push_back(i);
    const auto count = static_cast<Index>(seen_.size());
    MatrixXd scaled(count, count);
    for (Index i = 0; i < count; ++i)
      for (Index j = 0; j < count; ++j) scaled(i, j) = curvature(at(i), at(j)) / (scale_[at(i)] * scale_[at(j)]);
    if (count == 0) return;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(scaled);
    values_ = solver.eigenvalues();
    vectors_ = solver.eigenvectors();
  }

  bool is_seen(Index number) const { return scale_[number] > 0.0; }
  /// The numbers that the recordings decide only together with this one, itself included; empty: it is decided alone.
  std::vector<Index> bound_to(Index number) const {
    std::vector<Index> bound;
    const auto row = std::ranges::find(seen_, number) - seen_.begin();
    for (Index j = 0; j < values_.size(); ++j) {
      if (values_[j] > no_curvature || vectors_(row, j) * vectors_(row, j) < part_of_direction) continue;
      for (Index i = 0; i < values_.size(); ++i)
        if (vectors_(i, j) * vectors_(i, j) >= part_of_direction && std::ranges::find(bound, at(i)) == bound.end())
          bound.push_back(at(i));
    }
    return bound;
  }
  /// The covariance of the numbers in the directions that are decided.
  MatrixXd covariance() const {
    MatrixXd all = MatrixXd::Zero(scale_.size(), scale_.size());
    for (Index j = 0; j < values_.size(); ++j) {
      if (values_[j] <= no_curvature) continue;
      for (Index a = 0; a < values_.size(); ++a)
        for (Index b = 0; b < values_.size(); ++b)
          all(at(a), at(b)) += vectors_(a, j) * vectors_(b, j) / (values_[j] * scale_[at(a)] * scale_[at(b)]);
    }
    return all;
  }

 private:
  Index at(Index i) const { return seen_[static_cast<std::size_t>(i)]; }

  VectorXd scale_;
  std::vector<Index> seen_;
  VectorXd values_;
  MatrixXd vectors_;
};

std::string names_of(const FitPlaces& places, const std::vector<Index>& numbers, Index without) {
  std::string names;
  for (const Index number : numbers)
    if (number != without) names += (names.empty() ? "" : " and ") + places[static_cast<std::size_t>(number)].path;
  return names;
}

}  // namespace

void identify(const FitPlaces& places, const FitSums& sums, FitResult& result) {
  const Directions directions(sums.curvature);
  MatrixXd covariance = directions.covariance() * std::pow(std::max(1.0, sums.ratio), 2);
  if (sums.spread.size() > 0) covariance = sums.spread;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const FitPlace& place = places[i];
    FittedNumber number{place.path, place.unit, place.nominal, place.low, place.high, sums.best[at], 0.0, 0.0, {}, {}};
    double variance = covariance(at, at);
    if (place.stddev) variance = 1.0 / (1.0 / variance + 1.0 / (*place.stddev * *place.stddev));
    const double half = deviations_of_95_percent * std::sqrt(variance);
    number.low = std::max(number.value - half, place.low);
    number.high = std::min(number.value + half, place.high);
    const double without_prior = 2.0 * deviations_of_95_percent * std::sqrt(covariance(at, at));
    const std::vector<Index> bound = directions.is_seen(at) ? directions.bound_to(at) : std::vector<Index>();
    const bool is_bound = bound.size() > 1;
    if (!directions.is_seen(at) || bound.size() == 1) {
      number.reason = "nothing that is compared depends on it";
    } else if (is_bound) {
      number.reason = fmt::format("its effect is that of {}: vary one of them", names_of(places, bound, at));
    } else if (without_prior > share_of_bounds * place.range() ||
               (place.has_usual_bounds && without_prior > std::abs(number.value))) {
      number.reason = fmt::format("{:.4g} to {:.4g} explain the recording within its noise", number.low, number.high);
    }
    if (!number.is_identified()) {
      if (!is_bound) number.advice = advice_for(place.path);
      number.value = number.low = number.high = std::numeric_limits<double>::quiet_NaN();
    }
    result.numbers.push_back(std::move(number));
  }
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = a + 1; b < places.size(); ++b) {
      if (!result.numbers[a].is_identified() || !result.numbers[b].is_identified()) continue;
      const auto i = static_cast<Index>(a), j = static_cast<Index>(b);
      const double correlation = covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
      if (std::abs(correlation) > related) result.correlations.push_back({places[a].path, places[b].path, correlation});
    }
}

}  // namespace rehearse
