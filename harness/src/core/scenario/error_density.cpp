// White noise as a density: the deviation of a sample is density / sqrt(interval of the samples).
#include "sensor_error.h"

#include <cmath>

namespace rehearse {

const ErrorForm density_error{
    .key = "density",
    .text = "white noise as data sheets state it: the deviation of a sample is density * sqrt(rate)",
    .unit = ErrorUnit::per_root_hertz,
    .range = {0.0, 1e6},
    .apply = [](const GivenError& error, const SensorSample& sample, ErrorMemory&, std::span<double> numbers) {
      const double root = std::sqrt(sample.interval);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] += error.numbers[i] / root * normal_draw(sample, sample.tick, 1, sample.place + i);
    }};

}  // namespace rehearse
