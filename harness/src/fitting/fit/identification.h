// What recordings decide about the numbers of a fit: intervals, correlations, and why a number isn't claimed. Internal.
#pragma once

#include <rehearse/fit.h>

#include <Eigen/Core>
#include <vector>

#include "fit_places.h"

namespace rehearse {

/// Standard deviations of a normal number that hold 95 %.
inline constexpr double deviations_of_95_percent = 1.959963984540054;

/// The sums over all stretches at the best numbers, each with the weight of its stretch.
struct FitSums {
  Eigen::VectorXd best;
  Eigen::MatrixXd curvature;  // of half the sum of squares, without what is known before
  double ratio = 1.0;         // root mean square of the differences, in multiples of the noise
  Eigen::MatrixXd spread;     // covariance by drawn sets of stretches; empty: from the curvature
};

/// Sets the values of `result`, their intervals, reasons and correlations.
void identify(const FitPlaces& places, const FitSums& sums, FitResult& result);

}  // namespace rehearse
