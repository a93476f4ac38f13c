// Statistics of measurements as they come, by Welford's recurrence.
#pragma once

#include <algorithm>
#include <cmath>
#include <mutex>

#include "libstatistics_collector/moving_average_statistics/types.hpp"

namespace libstatistics_collector::moving_average_statistics {

class MovingAverageStatistics {
 public:
  double Average() const { return GetStatistics().average; }
  double Max() const { return GetStatistics().max; }
  double Min() const { return GetStatistics().min; }
  /// Of the population.
  double StandardDeviation() const { return GetStatistics().standard_deviation; }
  StatisticData GetStatistics() const {
    const std::lock_guard lock(mutex_);
    return data_;
  }
  std::uint64_t GetCount() const { return GetStatistics().sample_count; }
  void Reset() {
    const std::lock_guard lock(mutex_);
    data_ = {};
    squares_ = 0.0;
  }
  /// Numbers that aren't finite are left out.
  virtual void AddMeasurement(double item) {
    if (!std::isfinite(item)) return;
    const std::lock_guard lock(mutex_);
    const double before = data_.sample_count == 0 ? 0.0 : data_.average;
    ++data_.sample_count;
    const auto count = static_cast<double>(data_.sample_count);
    data_.average = before + (item - before) / count;
    squares_ += (item - before) * (item - data_.average);
    data_.min = data_.sample_count == 1 ? item : std::min(data_.min, item);
    data_.max = data_.sample_count == 1 ? item : std::max(data_.max, item);
    data_.standard_deviation = std::sqrt(squares_ / count);
  }
  MovingAverageStatistics() = default;
  virtual ~MovingAverageStatistics() = default;

 private:
  mutable std::mutex mutex_;
  StatisticData data_;
  double squares_ = 0.0;  // sum of the squared distances from the average
};

}  // namespace libstatistics_collector::moving_average_statistics
