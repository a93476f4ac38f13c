// An error that begins, and may end, during the run.
#include "sensor_error.h"

namespace rehearse {

const ErrorForm offset_error{
    .key = "offset",
    .text = "an error that begins, and may end, during the run",
    .unit = ErrorUnit::quantity,
    .range = {-1e6, 1e6},
    .is_timed = true,
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += error.numbers[i];
    }};

}  // namespace rehearse
