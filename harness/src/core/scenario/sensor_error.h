// ErrorForm: everything that a scenario and a run know of one kind of error of a quantity.
//
// A kind is one file of this folder, error_NAME.cpp, which defines NAME_error, and a row of sensor_errors.inl.
#pragma once

#include <rehearse/sensor_errors.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "scenario_values.h"

namespace rehearse {

/// The unit of an error's number.
enum class ErrorUnit : std::uint8_t {
  quantity,         // that of the quantity
  per_root_hertz,   // that of the quantity / sqrt(Hz): a density
  per_root_second,  // that of the quantity / sqrt(s): a walk
  share,            // none, or %
  angle,            // [rad]
  per_turn,         // of a joint that slides: per metre
  none,
};

/// The quantities that may have an error.
enum class ErrorOf : std::uint8_t { any, with_axes, displacement, color };

/// The sample that is disturbed.
struct SensorSample {
  std::uint64_t key = 0;   // of the sensor's random numbers
  std::int64_t tick = 0;   // of the sample
  std::int64_t index = 0;  // of the sample, from 0
  double interval = 0.0;   // between samples [s]
  std::size_t place = 0;   // index in the reading of the first disturbed number
  std::size_t first = 0;   // index in the reading of the quantity's first number
};

/// The part of an error that earlier samples determine. It follows from the random numbers alone, so that a run which
/// continues from a checkpoint makes it anew.
struct ErrorMemory {
  std::int64_t samples = 0;
  std::array<double, 3> sums{};
};

struct ErrorForm {
  std::string_view key;
  std::string_view text;  // of the key
  ErrorUnit unit;
  Range range;
  ErrorOf of = ErrorOf::any;
  double neutral = 0.0;       // the number that changes nothing
  bool is_timed = false;      // written as {by: N, from: T, until: T}
  bool records_truth = true;  // false: recordings with this error alone have no channel of true values
  /// Changes the numbers of a sample: all axes of a quantity with axes, else one number.
  void (*apply)(const GivenError& error, const SensorSample& sample, ErrorMemory& memory, std::span<double> numbers);
};

// Each is defined in the file of its name.
#define REHEARSE_ERROR(name) extern const ErrorForm name##_error;
#include "sensor_errors.inl"
#undef REHEARSE_ERROR

/// The errors in the order in which they act.
std::span<const ErrorForm* const> error_forms();

/// A number of the standard normal distribution. Errors have different streams; places are those in a reading.
double normal_draw(const SensorSample& sample, std::int64_t at, std::uint64_t stream, std::size_t place);
/// A number between 0 and 1, both excluded.
double uniform_draw(const SensorSample& sample, std::int64_t at, std::uint64_t stream, std::size_t place);

/// The units in which an error of a quantity can be written. `linear`: of a joint, whether it slides.
std::span<const Spelling> units_of_error(ErrorUnit unit, const MeasuredQuantity& quantity, bool linear);

}  // namespace rehearse
