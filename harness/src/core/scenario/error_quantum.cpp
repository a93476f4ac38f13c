// The step of a sensor's numbers: they are rounded to its multiples.
#include "sensor_error.h"

#include <cmath>

namespace rehearse {

const ErrorForm quantum_error{
    .key = "quantum",
    .text = "numbers are rounded to its multiples",
    .unit = ErrorUnit::quantity,
    .range = {0.0, 1e6},
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i)
        if (error.numbers[i] > 0.0) numbers[i] = std::round(numbers[i] / error.numbers[i]) * error.numbers[i];
    }};

}  // namespace rehearse
