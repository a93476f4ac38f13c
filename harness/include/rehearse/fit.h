// Fits numbers of a scenario to recordings of a robot: masses, friction, delays, gains.
//
// A recording is cut into stretches. In each, a world of the scenario begins in the recorded state, moves by the
// recorded commands, and is compared with the recording tick by tick. A stretch is short, so that errors don't
// accumulate. Its first state is complete if the recording has checkpoints; else the displacements and velocities of
// the joints are estimated from the stretch itself, which needs a fixed base. Differences are divided by the noise of
// their series, which is measured in the recording: the third differences of its numbers.
//
// The numbers are those that make the sum of squares smallest (Levenberg and Marquardt, with central differences).
// Stretches that differ much more than most count less. A number is claimed only if the recording decides it. The
// result has the same bits for any number of processes.
#pragma once

#include <rehearse/diagnostic.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rehearse {

/// A number of the scenario that is fitted.
struct FitRequest {
  std::string path;  // as in `vary:`
  /// Bounds, in the unit in which the scenario states the number. None: those of the path's entry of `vary:`; without
  /// an entry a tenth of the stated number to ten times it.
  std::optional<double> low, high;
};

struct FitOptions {
  std::vector<FitRequest> vary;
  double horizon = 0.05;  // length of the compared part of a stretch [s]
  std::size_t jobs = 1;   // processes
  int bootstrap = 0;      // sets of stretches that are drawn for the intervals; 0: intervals from the curvature
  /// Called with the evaluations so far; null: never.
  std::function<void(std::int64_t evaluations)> progress;
};

/// A number, its interval of 95 %, and why it isn't claimed. All in the unit in which the scenario states it.
struct FittedNumber {
  std::string path;
  std::string unit;  // as the scenario writes it; empty: it writes none
  double was = 0.0;
  double bound_low = 0.0, bound_high = 0.0;
  double value = 0.0;  // meaningful only if it is identified
  double low = 0.0, high = 0.0;
  std::string reason;  // why the recordings don't decide it; empty: they do
  std::string advice;  // what motion could decide it; empty: none is known

  bool is_identified() const { return reason.empty(); }
};

/// Two identified numbers whose errors are related.
struct FitCorrelation {
  std::string a, b;          // paths
  double correlation = 0.0;  // its magnitude is above 0.95
};

/// The noise of a series of a recording, and what is left there after the fit.
struct FitSeriesResidual {
  std::string recording, series;
  double noise = 0.0;   // standard deviation, in the unit of the series
  double before = 0.0;  // root mean square of the differences, in multiples of the noise
  double after = 0.0;
};

struct FitResult {
  std::vector<FittedNumber> numbers;
  std::vector<FitCorrelation> correlations;
  double before = 0.0, after = 0.0;  // root mean square of all differences, in multiples of the noise
  std::vector<FitSeriesResidual> series;
  std::int64_t stretches = 0;
  std::int64_t evaluations = 0;
  bool has_complete_states = false;  // of all recordings
  std::string text;                  // the scenario with the identified numbers

  bool identifies_any() const;
};

/// Fits the numbers of a scenario to the recordings. Fails if a path leads to no number, a number has no bounds, a
/// recording doesn't fit the scenario, or the state of the world isn't known.
Result<FitResult> fit(const std::filesystem::path& scenario, const std::vector<std::string>& recordings,
                      const FitOptions& options);

struct FitJudgement {
  double before = 0.0, after = 0.0;  // in multiples of the noise of that recording
};

/// Compares another recording with the scenario and with the fitted one.
Result<FitJudgement> judge_fit(const std::filesystem::path& scenario, const FitResult& fitted,
                               const std::string& recording, const FitOptions& options);

/// A number that was fitted to two recordings.
struct WornNumber {
  FittedNumber earlier, later;
  double probability = 1.0;  // of such a difference by noise alone; of identified numbers
  bool has_moved = false;    // the intervals don't overlap, and that probability is below 0.05 / count of the numbers
};

/// Compares the fits to two recordings, number by number.
std::vector<WornNumber> wear(const FitResult& earlier, const FitResult& later);

}  // namespace rehearse
