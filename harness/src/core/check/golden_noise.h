// The measured noise of a golden, in a check of it. Internal.
#pragma once

#include <rehearse/check.h>

#include <optional>
#include <string>
#include <vector>

#include "core/replay/plant_level.h"
#include "noise_floor.h"

namespace rehearse {

/// A golden without a measurement is valid: then all members are empty.
class GoldenNoise {
 public:
  /// Reads the measurement beside the golden. One that can't be read is a remark.
  static Result<GoldenNoise> of(const Trace& golden, std::vector<std::string>& remarks);

  NoiseOfSeries of_series() const { return floor_ ? noise_of_series(*floor_, *golden_) : NoiseOfSeries(); }
  /// [s]
  std::optional<double> estimated_horizon() const;
  /// Adds remarks on tolerances that don't agree with the noise.
  void judge_tolerances(const Scenario& scenario, CheckReport& report) const;

 private:
  std::optional<NoiseFloor> floor_;
  std::optional<Trace> golden_;  // the whole golden, for the hash of its numbers
};

}  // namespace rehearse
