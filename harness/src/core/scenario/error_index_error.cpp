// The zero of an encoder that has found its index: one draw in each run, evenly between its bounds.
#include "sensor_error.h"

namespace rehearse {

const ErrorForm index_error_error{
    .key = "index_error",
    .text = "the zero of an encoder, drawn once a run between plus and minus this",
    .unit = ErrorUnit::quantity,
    .range = {0.0, 1e6},
    .of = ErrorOf::displacement,
    .apply = [](const GivenError& error, const SensorSample& sample, ErrorMemory&, std::span<double> numbers) {
      const double draw = 2.0 * uniform_draw(sample, 0, 3, sample.first) - 1.0;
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += error.numbers[i] * draw;
    }};

}  // namespace rehearse
