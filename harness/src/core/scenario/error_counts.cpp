// The counts of an encoder in a turn (in a metre, of a joint that slides): each begins at a multiple.
#include "sensor_error.h"

#include <cmath>

namespace rehearse {

const ErrorForm counts_error{
    .key = "counts",
    .text = "counts of an encoder in a turn, or in a metre; each begins at a multiple",
    .unit = ErrorUnit::per_turn,
    .range = {1.0, 1e9},
    .of = ErrorOf::displacement,
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      const double counts = error.numbers[0];
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = std::floor(numbers[i] * counts) / counts;
    }};

}  // namespace rehearse
