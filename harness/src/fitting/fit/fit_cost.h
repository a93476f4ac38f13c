// FitCost: the sum of squares of a fit, stretch by stretch, and its derivatives. Processes make the stretches.
// Internal.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/scenario.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "fit_places.h"
#include "flown_motion.h"

namespace rehearse {

/// What a stretch adds to the sum of squares of the differences, each divided by the noise of its series. A start that
/// is estimated is that of the smallest sum; directions in which it moves the numbers are taken out of the derivatives.
struct StretchSum {
  double squares = 0.0;
  double freedom = 0.0;           // count of the numbers without that of what was estimated
  std::vector<double> of_series;  // squares by series of its recording
  Eigen::VectorXd gradient;       // J^T r by place, r = (recorded - predicted) / noise
  Eigen::MatrixXd curvature;      // J^T J
  bool has_exploded = false;

  double root_mean_square() const;
};

class FitCost {
 public:
  /// All must outlive this.
  FitCost(const FitPlaces& places, const std::vector<std::unique_ptr<const FlownMotion>>& motions, std::size_t jobs);

  /// The sums of all stretches, in order. Fails if the scenario can't have these numbers, or a signal came.
  Result<std::vector<StretchSum>> evaluate(const Eigen::VectorXd& numbers, bool with_derivatives);
  std::int64_t evaluations() const { return evaluations_; }
  std::size_t stretches() const { return all_.size(); }
  /// The recording of a stretch.
  std::size_t motion_of(std::size_t stretch) const { return all_[stretch].motion; }
  std::size_t ticks_of(std::size_t stretch) const;

 private:
  struct Part {
    std::size_t motion, stretch;
  };

  const FitPlaces& places_;
  const std::vector<std::unique_ptr<const FlownMotion>>& motions_;
  std::size_t jobs_;
  std::vector<Part> all_;
  std::int64_t evaluations_ = 0;
};

}  // namespace rehearse
