// The largest magnitude that a sensor measures.
#include "sensor_error.h"

#include <algorithm>
#include <limits>

namespace rehearse {

const ErrorForm saturation_error{
    .key = "saturation",
    .text = "the largest magnitude that is measured",
    .unit = ErrorUnit::quantity,
    .range = {0.0, 1e9},
    .neutral = std::numeric_limits<double>::infinity(),
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = std::clamp(numbers[i], -error.numbers[i], error.numbers[i]);
    }};

}  // namespace rehearse
