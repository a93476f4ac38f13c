#include "base/chance.h"
#include "normal_quantile.h"
#include "sensor_error.h"

namespace rehearse {
namespace {

constexpr int place_bits = 40;  // of a number of a stream: more places than a reading has

std::uint64_t number_of(std::uint64_t stream, std::size_t place) { return (stream << place_bits) | place; }

}  // namespace

double normal_draw(const SensorSample& sample, std::int64_t at, std::uint64_t stream, std::size_t place) {
  return normal_quantile(uniform_draw(sample, at, stream, place));
}

double uniform_draw(const SensorSample& sample, std::int64_t at, std::uint64_t stream, std::size_t place) {
  return Chance(sample.key, at).uniform(number_of(stream, place));
}

}  // namespace rehearse
