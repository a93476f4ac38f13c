// Errors of sensors: the difference between the true values of sensors and joints and the readings of controllers, from
// a scenario's `noise:` and `faults:`.
//
// A sample passes through the errors of its quantities in the order of core/scenario/sensor_errors.inl, where each has
// one row. Then it waits for its delay, or is lost. Random numbers are functions of the scenario's seed, the sensor's
// name, the tick and the index of the number in the reading. They depend on nothing else. So errors of one sensor
// change no other sensor's, and a run that continues from a checkpoint has the same errors.
#pragma once

#include <rehearse/model.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

namespace rehearse {

struct ErrorForm;  // a row of the errors of a quantity: core/scenario/sensor_error.h

/// displacement, velocity and effort. Their unit is "rad or m" and so on.
inline constexpr std::size_t joint_quantity_count = 3;
extern const std::array<MeasuredQuantity, joint_quantity_count> joint_quantities;

/// A span of time: from <= t < until.
struct Spell {
  double from = 0.0;                                       // [s]
  double until = std::numeric_limits<double>::infinity();  // [s]

  bool holds(double time) const { return from <= time && time < until; }
};

/// An error of a quantity, with its numbers by axis. A quantity without axes uses the first one.
struct GivenError {
  const ErrorForm* form = nullptr;
  std::array<double, 3> numbers{};
  Spell when{};
};

/// The errors of a quantity, in the order in which they act.
struct QuantityErrors {
  std::vector<GivenError> given;

  bool changes_nothing() const { return given.empty(); }
  /// The numbers of the error with that key of the scenario; zeros if it isn't given.
  Eigen::Vector3d of(std::string_view key) const;
};

/// A delay in addition to that of all readings.
struct ExtraDelay {
  double by = 0.0;  // [s]
  Spell when;       // of the samples
};

/// The errors of the readings of a sensor or of a joint.
struct ReadingErrors {
  /// In the order of quantities_of() or joint_quantities; empty: none has errors.
  std::vector<QuantityErrors> quantities;
  double rate = 0.0;     // of samples [Hz]; 0: each tick. Cameras and range sensors have their own rate.
  double phase = 0.0;    // time of the first sample [s]
  double latency = 0.0;  // from a sample to its arrival at the first tick that isn't earlier [s]
  double jitter = 0.0;   // the latency of each sample lies evenly between latency - jitter and latency + jitter [s]
  /// Share of the readings that are missing, 0 to 1. Without bursts it is, for a RangeSensor, the share of beams
  /// without measurement and, for a RangeCamera, the share of depths without measurement.
  double dropout = 0.0;
  /// Mean duration of a gap [s]; 0: each reading is lost or not, whatever happened to the last one. Gaps are those of
  /// E. N. Gilbert, Capacity of a Burst-Noise Channel, Bell System Technical Journal 39 (1960): a chain of two states.
  double burst = 0.0;
  Exposure exposure;                // of a camera; no deviation of a reading: its pictures are drawn so
  std::vector<Spell> stuck;         // the sample before is repeated
  std::vector<Spell> lost;          // there are no samples
  std::vector<ExtraDelay> delayed;  // samples arrive later

  bool changes_nothing() const;
  /// Whether readings come at other times than samples of each tick.
  bool is_timed() const;
  /// Whether the true values are recorded beside the readings: not for stddev, bias and dropout alone.
  bool records_truth() const;
};

/// The errors of a body's sensors and joints in a scenario. Empty lists: none.
struct BodyErrors {
  std::vector<ReadingErrors> devices;  // by device index
  std::vector<ReadingErrors> joints;   // by joint id

  /// Whether the readings of any joint differ from the truth.
  bool disturbs_joints() const;
};

}  // namespace rehearse
