// The share of each other axis that an axis measures, too.
#include "sensor_error.h"

namespace rehearse {

const ErrorForm cross_axis_error{
    .key = "cross_axis",
    .text = "share of each other axis that an axis measures, too",
    .unit = ErrorUnit::share,
    .range = {-1.0, 1.0},
    .of = ErrorOf::with_axes,
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      const double sum = numbers[0] + numbers[1] + numbers[2];
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += error.numbers[i] * (sum - numbers[i]);
    }};

}  // namespace rehearse
