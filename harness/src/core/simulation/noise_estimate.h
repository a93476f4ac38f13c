// NoiseEstimate: the standard deviation of independent errors of a series, from its third differences. Internal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/median.h"

namespace rehearse {

class NoiseEstimate {
 public:
  void add(double number) {
    if (count_ > 0 && number != last_[0]) step_ = std::min(step_, std::abs(number - last_[0]));
    if (count_ >= 3)
      differences_.push_back(static_cast<float>(std::abs(number - 3 * last_[0] + 3 * last_[1] - last_[2])));
    last_ = {number, last_[0], last_[1]};
    ++count_;
  }
  /// Numbers are missing before the next one.
  void interrupt() { count_ = 0; }
  std::size_t samples() const { return differences_.size(); }
  /// Numbers that are rounded to steps have at least the noise of rounding. 0: there are too few numbers.
  double value() const {
    if (differences_.empty()) return 0.0;
    // the median of the magnitude of a normal number is 1 / 1.4826; third differences have the variance 1 + 9 + 9 + 1
    const double robust = 1.4826 * static_cast<double>(upper_median(differences_)) / std::sqrt(20.0);
    return std::isfinite(step_) ? std::max(robust, step_ / std::sqrt(12.0)) : robust;
  }

 private:
  std::array<double, 3> last_{};
  int count_ = 0;
  double step_ = std::numeric_limits<double>::infinity();
  std::vector<float> differences_;
};

}  // namespace rehearse
