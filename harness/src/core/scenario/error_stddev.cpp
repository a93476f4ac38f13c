// White noise of each sample.
#include "sensor_error.h"

namespace rehearse {

const ErrorForm stddev_error{
    .key = "stddev",
    .text = "white noise of each sample",
    .unit = ErrorUnit::quantity,
    .range = {0.0, 1e6},
    .records_truth = false,
    .apply = [](const GivenError& error, const SensorSample& sample, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] += error.numbers[i] * normal_draw(sample, sample.tick, 0, sample.place + i);
    }};

}  // namespace rehearse
