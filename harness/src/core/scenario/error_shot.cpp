// The shot noise of a camera: of N photons sqrt(N) more or fewer are counted, so the variance of a color is in
// proportion to it.
#include "sensor_error.h"

#include <algorithm>
#include <cmath>

namespace rehearse {

const ErrorForm shot_error{
    .key = "shot",
    .text = "white noise by the number of photons: the deviation of a color c is shot * sqrt(c)",
    .unit = ErrorUnit::none,
    .range = {0.0, 1e3},
    .of = ErrorOf::color,
    .apply = [](const GivenError& error, const SensorSample& sample, ErrorMemory&, std::span<double> numbers) {
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] += error.numbers[i] * std::sqrt(std::max(0.0, numbers[i])) *
                      normal_draw(sample, sample.tick, 4, sample.place + i);
    }};

}  // namespace rehearse
