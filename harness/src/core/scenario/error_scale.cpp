// A factor of each axis.
#include "sensor_error.h"

namespace rehearse {

const ErrorForm scale_error{
    .key = "scale",
    .text = "a factor of each axis; 1 changes nothing",
    .unit = ErrorUnit::none,
    .range = {-1e3, 1e3},
    .neutral = 1.0,
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] *= error.numbers[i];
    }};

}  // namespace rehearse
