// A bias that walks at random: its deviation after the time t is bias_walk * sqrt(t).
#include "sensor_error.h"

#include <cmath>

namespace rehearse {

const ErrorForm bias_walk_error{
    .key = "bias_walk",
    .text = "a bias that walks at random: its deviation after the time t is bias_walk * sqrt(t)",
    .unit = ErrorUnit::per_root_second,
    .range = {0.0, 1e6},
    .apply = [](const GivenError& error, const SensorSample& sample, ErrorMemory& memory, std::span<double> numbers) {
      const double root = std::sqrt(sample.interval);
      for (; memory.samples < sample.index; ++memory.samples)
        for (std::size_t i = 0; i < numbers.size(); ++i)
          memory.sums[i] += error.numbers[i] * root * normal_draw(sample, memory.samples, 2, sample.first + i);
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += memory.sums[i];
    }};

}  // namespace rehearse
