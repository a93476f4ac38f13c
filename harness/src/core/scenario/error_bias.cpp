// A constant error of each axis.
#include "sensor_error.h"

namespace rehearse {

const ErrorForm bias_error{
    .key = "bias",
    .text = "a constant error of each axis",
    .unit = ErrorUnit::quantity,
    .range = {-1e6, 1e6},
    .records_truth = false,
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += error.numbers[i];
    }};

}  // namespace rehearse
