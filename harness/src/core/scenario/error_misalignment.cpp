// The rotation of a sensor's axes against those that its model states: roll, pitch, yaw about fixed axes.
#include "sensor_error.h"

#include <Eigen/Core>
#include <utility>

namespace rehearse {
namespace {

/// sin(x) and cos(x) of a small angle, without the functions of libm, whose last bits depend on the processor.
std::pair<double, double> sine_and_cosine(double x) {
  double sine = 0.0, cosine = 0.0;
  for (int term = 16; term > 0; term -= 2) {  // 0.5^17 / 17! is below 1e-19
    cosine = 1.0 - x * x / ((term - 1) * term) * (term == 16 ? 1.0 : cosine);
    sine = 1.0 - x * x / (term * (term + 1)) * (term == 16 ? 1.0 : sine);
  }
  return {x * sine, cosine};
}

Eigen::Matrix3d turn_about(int axis, double angle) {
  const auto [sine, cosine] = sine_and_cosine(angle);
  const int next = (axis + 1) % 3, last = (axis + 2) % 3;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn(next, next) = turn(last, last) = cosine;
  turn(next, last) = -sine;
  turn(last, next) = sine;
  return turn;
}

}  // namespace

const ErrorForm misalignment_error{
    .key = "misalignment",
    .text = "roll, pitch and yaw of the sensor's axes against those of the model",
    .unit = ErrorUnit::angle,
    .range = {-0.5, 0.5, "[rad]"},
    .of = ErrorOf::with_axes,
    .apply = [](const GivenError& error, const SensorSample&, ErrorMemory&, std::span<double> numbers) {
      const Eigen::Matrix3d turned =
          turn_about(2, error.numbers[2]) * turn_about(1, error.numbers[1]) * turn_about(0, error.numbers[0]);
      Eigen::Map<Eigen::Vector3d> vector(numbers.data());
      vector = (turned.transpose() * vector).eval();
    }};

}  // namespace rehearse
