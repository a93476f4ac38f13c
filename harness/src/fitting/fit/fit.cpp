// The iterations of a fit.
#include <fmt/format.h>
#include <rehearse/fit.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "base/chance.h"
#include "base/median.h"
#include "fit_cost.h"
#include "fit_places.h"
#include "flown_motion.h"
#include "identification.h"

namespace rehearse {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_iterations = 30;
constexpr int most_refusals = 8;        // of one iteration, each with ten times the damping
constexpr double first_damping = 1e-3;  // of the diagonal
constexpr double least_damping = 1e-9;
constexpr double small_step = 0.01;     // in standard deviations of the number: the iterations end
constexpr double small_share = 1e-9;    // of the distance of the bounds: likewise
constexpr double far_off = 3.0;         // times the median stretch: it counts less
constexpr int delays_tried = 21;        // evenly over their bounds
constexpr double longest_memory = 1.0;  // [s]

using Sums = std::vector<StretchSum>;

/// The weight of each stretch: those that differ much more than most count as if they differed far_off times as much.
std::vector<double> weights_of(const Sums& sums) {
  std::vector<double> sizes;
  for (const StretchSum& sum : sums) sizes.push_back(sum.root_mean_square());
  const double limit = far_off * std::max(1.0, upper_median(sizes));
  std::vector<double> weights;
  for (const double size : sizes) weights.push_back(size > limit ? limit / size : 1.0);
  return weights;
}

/// The root mean square of the differences in multiples of the noise.
double ratio_of(const Sums& sums, const std::vector<double>& weights) {
  double squares = 0.0, freedom = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    squares += weights[i] * sums[i].squares;
    freedom += weights[i] * sums[i].freedom;
  }
  return freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0;
}

class Fitting {
 public:
  Fitting(const FitPlaces& places, const FitOptions& options, FitCost& cost)
      : places_(places), options_(options), cost_(cost), best_(static_cast<Index>(places.size())) {
    for (Index i = 0; i < best_.size(); ++i) best_[i] = std::clamp(place(i).nominal, place(i).low, place(i).high);
  }

  Result<void> go();
  FitSums sums() const;
  const Sums& nominal() const { return nominal_; }
  const Sums& stretches() const { return now_; }

 private:
  const FitPlace& place(Index i) const { return places_[static_cast<std::size_t>(i)]; }
  Result<Sums> evaluate(const VectorXd& numbers, bool with_derivatives) {
    if (options_.progress) options_.progress(cost_.evaluations());
    return cost_.evaluate(numbers, with_derivatives);
  }
  double sum_at(const VectorXd& numbers, const Sums& sums, const std::vector<double>& weights) const;
  void add(const Sums& sums, const std::vector<double>& weights, VectorXd& gradient, MatrixXd& curvature) const;
  void add_known(const VectorXd& numbers, VectorXd& gradient, MatrixXd& curvature) const;
  VectorXd step_of(const VectorXd& gradient, const MatrixXd& curvature, double damping) const;
  bool is_small(const VectorXd& step, const MatrixXd& curvature) const;
  Result<void> search_delays();
  Result<std::optional<VectorXd>> better_step(const VectorXd& gradient, const MatrixXd& curvature, double& damping);
  Result<void> iterate();
  MatrixXd spread_of_sets() const;

  const FitPlaces& places_;
  const FitOptions& options_;
  FitCost& cost_;
  VectorXd best_;
  Sums nominal_, now_;
  std::vector<double> weights_;
};

/// The weighted sum of squares, with what is known before.
double Fitting::sum_at(const VectorXd& numbers, const Sums& sums, const std::vector<double>& weights) const {
  double all = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) all += weights[i] * sums[i].squares;
  for (Index i = 0; i < numbers.size(); ++i)
    if (place(i).stddev) all += std::pow((numbers[i] - *place(i).mean) / *place(i).stddev, 2);
  return all;
}

void Fitting::add(const Sums& sums, const std::vector<double>& weights, VectorXd& gradient, MatrixXd& curvature) const {
  gradient = VectorXd::Zero(best_.size());
  curvature = MatrixXd::Zero(best_.size(), best_.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i].has_exploded) continue;
    gradient += weights[i] * sums[i].gradient;
    curvature += weights[i] * sums[i].curvature;
  }
}

void Fitting::add_known(const VectorXd& numbers, VectorXd& gradient, MatrixXd& curvature) const {
  for (Index i = 0; i < numbers.size(); ++i) {
    if (!place(i).stddev) continue;
    const double weight = 1.0 / (*place(i).stddev * *place(i).stddev);
    gradient[i] += weight * (*place(i).mean - numbers[i]);
    curvature(i, i) += weight;
  }
}

/// The step of Levenberg and Marquardt, within the bounds: numbers that would leave them stay.
VectorXd Fitting::step_of(const VectorXd& gradient, const MatrixXd& curvature, double damping) const {
  std::vector<Index> free;
  for (Index i = 0; i < best_.size(); ++i) {
    const bool is_stopped =
        (best_[i] <= place(i).low && gradient[i] < 0.0) || (best_[i] >= place(i).high && gradient[i] > 0.0);
    if (!is_stopped && curvature(i, i) > 0.0) free.push_back(i);
  }
  VectorXd step = VectorXd::Zero(best_.size());
  const auto count = static_cast<Index>(free.size());
  if (count == 0) return step;
  MatrixXd scaled(count, count);
  VectorXd right(count);
  for (Index a = 0; a < count; ++a) {
    const Index i = free[static_cast<std::size_t>(a)];
    right[a] = gradient[i] / std::sqrt(curvature(i, i));
    for (Index b = 0; b < count; ++b) {
      const Index j = free[static_cast<std::size_t>(b)];
      scaled(a, b) = curvature(i, j) / std::sqrt(curvature(i, i) * curvature(j, j));
    }
    scaled(a, a) += damping;
  }
  const VectorXd solved = scaled.ldlt().solve(right);
  for (Index a = 0; a < count; ++a) {
    const Index i = free[static_cast<std::size_t>(a)];
    const double to = best_[i] + solved[a] / std::sqrt(curvature(i, i));
    step[i] = std::clamp(to, place(i).low, place(i).high) - best_[i];
  }
  return step;
}

bool Fitting::is_small(const VectorXd& step, const MatrixXd& curvature) const {
  for (Index i = 0; i < step.size(); ++i) {
    const double deviation = curvature(i, i) > 0.0 ? 1.0 / std::sqrt(curvature(i, i)) : 0.0;
    if (std::abs(step[i]) > std::max(small_step * deviation, small_share * place(i).range())) return false;
  }
  return true;
}

/// Tries each delay over its bounds: the sum of squares may have several valleys.
Result<void> Fitting::search_delays() {
  for (Index i = 0; i < best_.size(); ++i) {
    if (!place(i).is_delay) continue;
    VectorXd tried = best_;
    double least = sum_at(best_, now_, weights_);
    for (int k = 0; k < delays_tried; ++k) {
      tried[i] = place(i).low + place(i).range() * k / (delays_tried - 1);
      const auto sums = REHEARSE_TRY(evaluate(tried, false));
      const double sum = sum_at(tried, sums, weights_);
      if (sum >= least) continue;
      least = sum;
      best_[i] = tried[i];
    }
  }
  return {};
}

/// A step that makes the sum smaller; nullopt: there is none. A step to numbers that no scenario can have is too long.
Result<std::optional<VectorXd>> Fitting::better_step(const VectorXd& gradient, const MatrixXd& curvature,
                                                     double& damping) {
  const double before = sum_at(best_, now_, weights_);
  for (int refused = 0; refused < most_refusals; ++refused) {
    const VectorXd step = step_of(gradient, curvature, damping);
    if (is_small(step, curvature)) return std::optional<VectorXd>();
    const VectorXd next = best_ + step;
    if (places_.scenario_with(next)) {
      const Sums sums = REHEARSE_TRY(evaluate(next, false));
      if (sum_at(next, sums, weights_) < before) {
        damping = std::max(least_damping, 0.1 * damping);
        return std::optional(step);
      }
    }
    damping = std::min(1e6, 10.0 * damping);
  }
  return std::optional<VectorXd>();
}

Result<void> Fitting::iterate() {
  double damping = first_damping;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    now_ = REHEARSE_TRY(evaluate(best_, true));
    weights_ = weights_of(now_);
    VectorXd gradient;
    MatrixXd curvature;
    add(now_, weights_, gradient, curvature);
    add_known(best_, gradient, curvature);
    const auto step = REHEARSE_TRY(better_step(gradient, curvature, damping));
    if (!step) return {};
    best_ += *step;
  }
  return error(fmt::format("the numbers still move after {} iterations", most_iterations),
               "vary fewer numbers, or state narrower bounds");
}

Result<void> Fitting::go() {
  VectorXd nominal = best_;
  for (Index i = 0; i < nominal.size(); ++i) nominal[i] = place(i).nominal;
  nominal_ = REHEARSE_TRY(evaluate(nominal, false));
  now_ = nominal_;
  weights_ = weights_of(now_);
  REHEARSE_TRY(search_delays());
  return iterate();
}

/// The covariance of the numbers over sets of stretches, which are drawn with replacement. For each set one step from
/// the best numbers is made.
MatrixXd Fitting::spread_of_sets() const {
  std::vector<VectorXd> drawn;
  for (int set = 0; set < options_.bootstrap; ++set) {
    const Chance chance(0, set);
    VectorXd gradient = VectorXd::Zero(best_.size());
    MatrixXd curvature = MatrixXd::Zero(best_.size(), best_.size());
    for (std::size_t i = 0; i < now_.size(); ++i) {
      const auto at =
          std::min(now_.size() - 1, static_cast<std::size_t>(chance.uniform(i) * static_cast<double>(now_.size())));
      gradient += weights_[at] * now_[at].gradient;
      curvature += weights_[at] * now_[at].curvature;
    }
    drawn.push_back(step_of(gradient, curvature, least_damping));
  }
  VectorXd mean = VectorXd::Zero(best_.size());
  for (const VectorXd& one : drawn) mean += one / static_cast<double>(drawn.size());
  MatrixXd spread = MatrixXd::Zero(best_.size(), best_.size());
  for (const VectorXd& one : drawn)
    spread += (one - mean) * (one - mean).transpose() / static_cast<double>(drawn.size() - 1);
  return spread;
}

FitSums Fitting::sums() const {
  FitSums sums;
  VectorXd gradient;
  add(now_, weights_, gradient, sums.curvature);
  sums.best = best_;
  sums.ratio = ratio_of(now_, weights_);
  if (options_.bootstrap > 1) sums.spread = spread_of_sets();
  return sums;
}

using Motions = std::vector<std::unique_ptr<const FlownMotion>>;

/// The ticks of stretches, from what drives may remember within the bounds.
FlownMotion::Extent extent_of(const FitPlaces& places, const FitOptions& options) {
  const auto count = static_cast<Index>(places.size());
  VectorXd low(count), high(count);
  for (Index i = 0; i < count; ++i) {
    low[i] = places[static_cast<std::size_t>(i)].low;
    high[i] = places[static_cast<std::size_t>(i)].high;
  }
  const double stated = memory_of_drives(places.nominal());
  double memory = stated;
  bool keeps_memory = true;
  for (const VectorXd& numbers : {low, high}) {
    const auto scenario = places.scenario_with(numbers);
    if (!scenario) continue;
    keeps_memory = keeps_memory && memory_of_drives(*scenario) == stated;
    memory = std::max(memory, memory_of_drives(*scenario));
  }
  const double step = places.nominal().time_step;
  const auto ticks = [&](double time) { return static_cast<std::int64_t>(std::ceil(time / step - 1e-9)); };
  return {std::max<std::int64_t>(2, ticks(options.horizon)), ticks(std::min(memory, longest_memory)), keeps_memory};
}

Result<Motions> motions_of(const FitPlaces& places, const std::vector<std::string>& recordings,
                           const FitOptions& options) {
  const FlownMotion::Extent extent = extent_of(places, options);
  Motions motions;
  for (const std::string& recording : recordings)
    motions.push_back(REHEARSE_TRY(FlownMotion::read(places.nominal(), recording, extent)));
  return motions;
}

/// The root mean square of each series before and after the fit.
std::vector<FitSeriesResidual> residuals_of(const Motions& motions, const FitCost& cost, const Sums& before,
                                            const Sums& after) {
  std::vector<FitSeriesResidual> residuals;
  for (std::size_t motion = 0; motion < motions.size(); ++motion)
    for (std::size_t i = 0; i < motions[motion]->series().size(); ++i) {
      const FlownSeries& series = motions[motion]->series()[i];
      FitSeriesResidual residual{motions[motion]->file(), series.name, series.noise, 0.0, 0.0};
      double ticks = 0.0;
      for (std::size_t stretch = 0; stretch < after.size(); ++stretch) {
        if (cost.motion_of(stretch) != motion) continue;
        residual.before += before[stretch].of_series[i];
        residual.after += after[stretch].of_series[i];
        ticks += static_cast<double>(cost.ticks_of(stretch));
      }
      residual.before = std::sqrt(residual.before / ticks);
      residual.after = std::sqrt(residual.after / ticks);
      residuals.push_back(std::move(residual));
    }
  return residuals;
}

/// The identified numbers; NaN in place of the others, which stay as they are stated.
VectorXd identified(const FitResult& result) {
  VectorXd numbers(static_cast<Index>(result.numbers.size()));
  for (Index i = 0; i < numbers.size(); ++i) {
    const FittedNumber& number = result.numbers[static_cast<std::size_t>(i)];
    numbers[i] = number.is_identified() ? number.value : std::numeric_limits<double>::quiet_NaN();
  }
  return numbers;
}

}  // namespace

bool FitResult::identifies_any() const {
  return std::ranges::any_of(numbers, [](const FittedNumber& number) { return number.is_identified(); });
}

Result<FitResult> fit(const std::filesystem::path& scenario, const std::vector<std::string>& recordings,
                      const FitOptions& options) {
  const FitPlaces places = REHEARSE_TRY(FitPlaces::find(scenario, options.vary));
  const Motions motions = REHEARSE_TRY(motions_of(places, recordings, options));
  FitCost cost(places, motions, options.jobs);
  Fitting fitting(places, options, cost);
  REHEARSE_TRY(fitting.go());
  FitResult result;
  const FitSums sums = fitting.sums();
  identify(places, sums, result);
  result.before = ratio_of(fitting.nominal(), weights_of(fitting.nominal()));
  result.after = sums.ratio;
  result.series = residuals_of(motions, cost, fitting.nominal(), fitting.stretches());
  result.stretches = static_cast<std::int64_t>(cost.stretches());
  result.evaluations = cost.evaluations();
  result.has_complete_states = std::ranges::all_of(motions, [](const auto& one) { return one->has_complete_states(); });
  result.text = REHEARSE_TRY(places.text_with(identified(result)));
  return result;
}

Result<FitJudgement> judge_fit(const std::filesystem::path& scenario, const FitResult& fitted,
                               const std::string& recording, const FitOptions& options) {
  const FitPlaces places = REHEARSE_TRY(FitPlaces::find(scenario, options.vary));
  const Motions motions = REHEARSE_TRY(motions_of(places, {recording}, options));
  FitCost cost(places, motions, options.jobs);
  VectorXd numbers = identified(fitted), nominal(numbers.size());
  for (Index i = 0; i < numbers.size(); ++i) {
    nominal[i] = places[static_cast<std::size_t>(i)].nominal;
    if (!std::isfinite(numbers[i])) numbers[i] = nominal[i];
  }
  FitJudgement judgement;
  const auto before = REHEARSE_TRY(cost.evaluate(nominal, false));
  judgement.before = ratio_of(before, weights_of(before));
  const auto after = REHEARSE_TRY(cost.evaluate(numbers, false));
  judgement.after = ratio_of(after, weights_of(after));
  return judgement;
}

}  // namespace rehearse
