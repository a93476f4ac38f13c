#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace libstatistics_collector::moving_average_statistics {

/// NaN where there is no sample.
struct StatisticData {
  double average = std::numeric_limits<double>::quiet_NaN();
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
  double standard_deviation = std::numeric_limits<double>::quiet_NaN();
  std::uint64_t sample_count = 0;
};

}  // namespace libstatistics_collector::moving_average_statistics
