#include "fit_cost.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "core/guard/answer.h"
#include "core/guard/float_mode.h"
#include "core/guard/interruption.h"
#include "core/guard/worker_pool.h"
#include "stretch_run.h"

namespace rehearse {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_parts = 64;         // of an evaluation, for the processes
constexpr int start_iterations = 8;            // for the start of a stretch, at most
constexpr int most_halvings = 4;               // of their steps
constexpr double small_gain = 0.01;            // of the sum of squares: they end
constexpr double least_start_step = 1e-7;      // of its differences [rad], [rad/s], [m] or [m/s]
constexpr double squares_of_explosion = 1e12;  // so that no such numbers are taken

/// A scenario whose numbers are those of an evaluation, or differ from them in one.
struct Variant {
  Scenario scenario;
  double difference = 0.0;  // of that number
};

/// The variants of an evaluation: the numbers themselves, and for each place one below and one above.
struct Variants {
  Scenario base;
  std::vector<std::optional<Variant>> below, above;
};

Result<Variants> variants_of(const FitPlaces& places, const VectorXd& numbers, bool with_derivatives) {
  Variants variants;
  variants.base = REHEARSE_TRY(places.scenario_with(numbers));
  if (!with_derivatives) return variants;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto at = static_cast<Index>(i);
    const double step = places[i].step_at(numbers[at]);
    Diagnostics refused;
    const auto varied = [&](double sign) -> std::optional<Variant> {
      VectorXd moved = numbers;
      moved[at] = std::clamp(numbers[at] + sign * step, places[i].low, places[i].high);
      if (moved[at] == numbers[at]) return std::nullopt;
      auto scenario = places.scenario_with(moved);
      if (scenario) return Variant{*std::move(scenario), moved[at] - numbers[at]};
      refused = scenario.errors();
      return std::nullopt;
    };
    variants.below.push_back(varied(-1.0));
    variants.above.push_back(varied(1.0));
    if (!variants.below.back() && !variants.above.back()) return refused;
  }
  return variants;
}

/// The worlds of the variants, for the stretches of a recording.
class Stretches {
 public:
  Stretches(const FitPlaces& places, const Variants& variants, const FlownMotion& motion)
      : places_(places), motion_(motion), base_(variants.base, places.nominal(), motion) {
    for (std::size_t i = 0; i < variants.below.size(); ++i) {
      add(variants.below[i]);
      add(variants.above[i]);
    }
  }

  Result<StretchSum> sum_of(const FlownStretch& stretch);

 private:
  struct Moved {
    StretchRun run;
    double difference;
  };
  void add(const std::optional<Variant>& variant) {
    moved_.emplace_back();
    if (variant)
      moved_.back() = std::make_unique<Moved>(
          Moved{StretchRun(variant->scenario, places_.nominal(), motion_), variant->difference});
  }
  /// The state in which a stretch begins.
  struct Start {
    VectorXd start;      // empty: the state is complete
    VectorXd predicted;  // the numbers that follow from it
    MatrixXd basis;      // of the directions in which it moves them; no columns: it isn't estimated
  };

  Index places() const { return static_cast<Index>(moved_.size() / 2); }
  Result<std::optional<Start>> estimate(const FlownStretch& stretch, const VectorXd& goal, const VectorXd& weight);
  Result<std::optional<MatrixXd>> slopes_at(const FlownStretch& stretch, const Start& here);
  VectorXd recorded(const FlownStretch& stretch) const;
  VectorXd first_start(const FlownStretch& stretch) const;
  VectorXd start_noise() const;
  double slope(const FlownStretch& stretch, std::size_t series) const;

  const FitPlaces& places_;
  const FlownMotion& motion_;
  StretchRun base_;
  std::vector<std::unique_ptr<Moved>> moved_;  // below and above by place; null: there is none
};

VectorXd Stretches::recorded(const FlownStretch& stretch) const {
  const auto width = static_cast<Index>(motion_.series().size());
  VectorXd numbers(static_cast<Index>(stretch.last - stretch.first + 1) * width);
  for (Index i = 0; i < numbers.size(); ++i)
    numbers[i] = motion_.measured(stretch.first + i / width, static_cast<std::size_t>(i % width));
  return numbers;
}

/// The slope of a series behind the start of a stretch, by least squares over some ticks.
double Stretches::slope(const FlownStretch& stretch, std::size_t series) const {
  const std::int64_t ticks = std::min<std::int64_t>(10, stretch.last - stretch.begin);
  const double middle = 0.5 * static_cast<double>(ticks);
  double products = 0.0, squares = 0.0;
  for (std::int64_t i = 0; i <= ticks; ++i) {
    const double distance = static_cast<double>(i) - middle;
    products += distance * motion_.measured(stretch.begin + i, series);
    squares += distance * distance;
  }
  return products / squares / places_.nominal().time_step;
}

VectorXd Stretches::first_start(const FlownStretch& stretch) const {
  const std::vector<std::size_t> ids = movable_joints(*places_.nominal().bodies[motion_.body()].model);
  VectorXd start = VectorXd::Zero(static_cast<Index>(2 * ids.size()));
  const std::vector<FlownSeries>& series = motion_.series();
  for (const bool velocities : {false, true})  // a measured velocity replaces that of the displacements
    for (std::size_t i = 0; i < series.size(); ++i) {
      if ((series[i].quantity == FlownSeries::Quantity::velocity) != velocities) continue;
      const auto joint = std::ranges::find(ids, static_cast<std::size_t>(series[i].index)) - ids.begin();
      const auto velocity = joint + static_cast<Index>(ids.size());
      if (!velocities) {
        start[joint] = motion_.measured(stretch.begin, i);
        start[velocity] = slope(stretch, i);
      } else {
        start[velocity] = motion_.measured(stretch.begin, i);
      }
    }
  return start;
}

/// The steps of differences of a start.
VectorXd Stretches::start_noise() const {
  const std::vector<std::size_t> ids = movable_joints(*places_.nominal().bodies[motion_.body()].model);
  VectorXd noise = VectorXd::Constant(static_cast<Index>(2 * ids.size()), least_start_step);
  for (const FlownSeries& series : motion_.series()) {
    const auto joint = std::ranges::find(ids, static_cast<std::size_t>(series.index)) - ids.begin();
    const bool is_velocity = series.quantity == FlownSeries::Quantity::velocity;
    const auto at = joint + (is_velocity ? static_cast<Index>(ids.size()) : 0);
    noise[at] = std::max(noise[at], series.noise);
  }
  return noise;
}

/// Estimates the start of a stretch by Gauss and Newton, unless its state is complete. nullopt: a world exploded.
Result<std::optional<Stretches::Start>> Stretches::estimate(const FlownStretch& stretch, const VectorXd& goal,
                                                            const VectorXd& weight) {
  Start here;
  here.basis = MatrixXd(goal.size(), 0);
  if (stretch.state.empty()) here.start = first_start(stretch);
  const auto begun = REHEARSE_TRY(base_.predict(stretch, here.start));
  if (!begun) return std::optional<Start>();
  here.predicted = *begun;
  if (!stretch.state.empty()) return std::optional(std::move(here));
  const VectorXd steps = start_noise();
  for (int iteration = 0; iteration < start_iterations; ++iteration) {
    MatrixXd slopes(goal.size(), here.start.size());
    for (Index i = 0; i < here.start.size(); ++i) {
      VectorXd moved = here.start;
      moved[i] += steps[i];
      const auto there = REHEARSE_TRY(base_.predict(stretch, moved));
      if (!there) return std::optional<Start>();
      slopes.col(i) = (*there - here.predicted).cwiseProduct(weight);  // by the noise of the start
    }
    const Eigen::ColPivHouseholderQR<MatrixXd> factors(slopes);
    here.basis = MatrixXd(factors.householderQ() * MatrixXd::Identity(goal.size(), factors.rank()));
    const VectorXd difference = (goal - here.predicted).cwiseProduct(weight);
    VectorXd step = VectorXd(factors.solve(difference)).cwiseProduct(steps);
    double gain = -1.0;
    for (int halving = 0; gain < 0.0 && halving < most_halvings; ++halving, step *= 0.5) {
      const auto there = REHEARSE_TRY(base_.predict(stretch, here.start + step));
      if (!there) continue;
      gain = difference.squaredNorm() - (goal - *there).cwiseProduct(weight).squaredNorm();
      if (gain < 0.0) continue;
      here.start += step;
      here.predicted = *there;
      break;
    }
    if (gain < small_gain) break;
  }
  return std::optional(std::move(here));
}

/// The derivatives of the numbers by each place; nullopt: a world exploded.
Result<std::optional<MatrixXd>> Stretches::slopes_at(const FlownStretch& stretch, const Start& here) {
  MatrixXd slopes(here.predicted.size(), places());
  for (Index place = 0; place < places(); ++place) {
    VectorXd low = here.predicted, high = here.predicted;
    double distance = 0.0;
    for (const bool is_above : {false, true}) {
      Moved* const moved = moved_[static_cast<std::size_t>(2 * place + (is_above ? 1 : 0))].get();
      if (!moved) continue;
      const auto numbers = REHEARSE_TRY(moved->run.predict(stretch, here.start));
      if (!numbers) return std::optional<MatrixXd>();
      (is_above ? high : low) = *numbers;
      distance += std::abs(moved->difference);
    }
    slopes.col(place) = (high - low) / distance;
  }
  return std::optional(std::move(slopes));
}

Result<StretchSum> Stretches::sum_of(const FlownStretch& stretch) {
  const auto width = static_cast<Index>(motion_.series().size());
  const VectorXd goal = recorded(stretch);
  VectorXd weight(goal.size());
  for (Index i = 0; i < goal.size(); ++i) weight[i] = 1.0 / motion_.series()[static_cast<std::size_t>(i % width)].noise;

  StretchSum sum;
  sum.gradient = VectorXd::Zero(places());
  sum.curvature = MatrixXd::Zero(places(), places());
  sum.of_series.assign(static_cast<std::size_t>(width), 0.0);
  const auto here = REHEARSE_TRY(estimate(stretch, goal, weight));
  std::optional<MatrixXd> slopes;
  if (here) slopes = REHEARSE_TRY(slopes_at(stretch, *here));
  if (!slopes) {
    sum.squares = squares_of_explosion;
    sum.freedom = static_cast<double>(goal.size());
    sum.has_exploded = true;
    return sum;
  }
  const auto without_start = [&](const VectorXd& numbers) -> VectorXd {
    return numbers - here->basis * (here->basis.transpose() * numbers);
  };
  const VectorXd left = without_start((goal - here->predicted).cwiseProduct(weight));
  for (Index place = 0; place < places(); ++place)
    slopes->col(place) = without_start(slopes->col(place).cwiseProduct(weight));
  sum.squares = left.squaredNorm();
  sum.freedom = static_cast<double>(goal.size() - here->basis.cols());
  for (Index i = 0; i < left.size(); ++i) sum.of_series[static_cast<std::size_t>(i % width)] += left[i] * left[i];
  sum.gradient = slopes->transpose() * left;
  sum.curvature = slopes->transpose() * *slopes;
  return sum;
}

}  // namespace

static std::vector<double> numbers_of(const MatrixXd& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

static void each_member(const StretchSum& sum, AnswerWriter& each) {
  each(sum.squares), each(sum.freedom), each(sum.has_exploded), each(sum.of_series);
  each(numbers_of(sum.gradient)), each(numbers_of(sum.curvature));
}

static void each_member(StretchSum& sum, AnswerReader& each) {
  std::vector<double> gradient, curvature;
  each(sum.squares), each(sum.freedom), each(sum.has_exploded), each(sum.of_series), each(gradient), each(curvature);
  const auto places = static_cast<Index>(gradient.size());
  if (curvature.size() != gradient.size() * gradient.size()) return;  // damaged: it has another size than the others
  sum.gradient = VectorXd::Map(gradient.data(), places);
  sum.curvature = MatrixXd::Map(curvature.data(), places, places);
}

double StretchSum::root_mean_square() const { return freedom > 0.0 ? std::sqrt(squares / freedom) : 0.0; }

FitCost::FitCost(const FitPlaces& places, const std::vector<std::unique_ptr<const FlownMotion>>& motions,
                 std::size_t jobs)
    : places_(places), motions_(motions), jobs_(std::max<std::size_t>(jobs, 1)) {
  for (std::size_t motion = 0; motion < motions.size(); ++motion)
    for (std::size_t i = 0; i < motions[motion]->stretches().size(); ++i) all_.push_back({motion, i});
}

std::size_t FitCost::ticks_of(std::size_t stretch) const {
  const FlownStretch& one = motions_[all_[stretch].motion]->stretches()[all_[stretch].stretch];
  return static_cast<std::size_t>(one.last - one.first + 1);
}

Result<std::vector<StretchSum>> FitCost::evaluate(const VectorXd& numbers, bool with_derivatives) {
  const StandardFloatMode float_mode;
  ++evaluations_;
  const Variants variants = REHEARSE_TRY(variants_of(places_, numbers, with_derivatives));
  const std::size_t parts = std::min(most_parts, all_.size());
  const auto begin_of = [&](std::size_t part) { return all_.size() * part / parts; };
  const auto make = [&](std::size_t part) -> Result<std::vector<StretchSum>> {
    std::vector<StretchSum> sums;
    std::unique_ptr<Stretches> worlds;
    std::optional<std::size_t> motion;
    for (std::size_t i = begin_of(part); i < begin_of(part + 1); ++i) {
      if (motion != all_[i].motion) {
        motion = all_[i].motion;
        worlds = std::make_unique<Stretches>(places_, variants, *motions_[*motion]);
      }
      sums.push_back(REHEARSE_TRY(worlds->sum_of(motions_[*motion]->stretches()[all_[i].stretch])));
    }
    return sums;
  };
  WorkerPool pool({WorkerPool::Kind::bare, std::min(jobs_, parts), {}, {}},
                  [&](std::int64_t job, const std::filesystem::path&) {
                    return WorkerPool::Made{packed_result(make(static_cast<std::size_t>(job)))};
                  });
  std::vector<std::vector<StretchSum>> made(parts);
  for (std::size_t given = 0, answered = 0; answered < parts;) {
    for (; given < parts && pool.has_room(); ++given) REHEARSE_TRY(pool.give(static_cast<std::int64_t>(given)));
    if (interruption() != 0) return error("interrupted");
    const auto answer = REHEARSE_TRY(pool.wait());
    if (!answer) continue;
    if (!answer->text) return error(fmt::format("a process of the fit ended {}", answer->end));
    made[static_cast<std::size_t>(answer->job)] = REHEARSE_TRY(unpacked_result<std::vector<StretchSum>>(*answer->text));
    ++answered;
  }
  std::vector<StretchSum> sums;
  for (std::vector<StretchSum>& part : made) std::ranges::move(part, std::back_inserter(sums));
  return sums;
}

}  // namespace rehearse
