// SensorErrors: the stage between the true readings of sensors and joints and those that the controllers see.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/recording/true_reading.h"
#include "core/scenario/sensor_error.h"
#include "reading_line.h"

namespace rehearse {

/// The key of the random numbers of a body's sensor, joint or actuator (`kind`) of that name.
std::uint64_t key_of(std::string_view kind, const std::string& body, const std::string& name, std::uint32_t seed);

class SensorErrors {
 public:
  /// The scenario must outlive this.
  explicit SensorErrors(const Scenario& scenario);

  /// Makes the readings of devices in this tick from the true ones. Must be called once for each tick, in order, with
  /// true readings: cameras and range sensors keep their last capture with its errors.
  void disturb_devices(std::int64_t tick, Observation& observation);
  /// The true values of the devices whose recording has them, in this tick.
  const std::vector<TrueReading>& truths() const { return truths_; }

  /// True if the readings of any joint differ from the truth.
  bool has_joints() const { return !joints_.empty(); }
  /// Makes the readings of joints from the true ones. Must be called once for each tick, in order.
  void disturb_joints(std::int64_t tick, Observation& observation);

  /// The part of the state that true values of earlier ticks determine, without captures; empty if no reading depends
  /// on them. Its size follows from the scenario.
  std::vector<std::byte> save();
  /// Continues after save() in a run of the same scenario; a state of another size begins without earlier readings.
  void restore(std::span<const std::byte> state);

 private:
  /// The errors of one sensor or joint, and what earlier samples left.
  struct Disturbed {
    Disturbed(const Scenario& scenario, int body, int index, const ReadingErrors& errors, std::uint64_t key,
              double interval, std::size_t numbers);

    int body = 0;
    int index = 0;  // of the device, or id of the joint
    const ReadingErrors* errors = nullptr;
    std::uint64_t key = 0;
    ReadingLine line;
    bool is_timed = false;
    std::vector<std::vector<ErrorMemory>> memories;                 // by quantity, then by error
    const Device* device = nullptr;                                 // null: a joint
    DeviceReading last{};                                           // of a camera or range sensor
    std::deque<std::pair<std::int64_t, DeviceReading>> captures{};  // of those, with the tick of their arrival
    std::vector<double> values{};                                   // scratch
  };

  static void disturb_numbers(Disturbed& target, std::size_t quantity, SensorSample sample, std::span<double> numbers);
  static void disturb_values(Disturbed& target, std::int64_t tick, DeviceReading& reading);
  static void pass_capture(Disturbed& target, std::int64_t tick, DeviceReading& reading);
  static void disturb_capture(Disturbed& target, const SensorSample& sample, DeviceReading& reading);
  template <class Floats>
  static void disturb_distances(Disturbed& target, std::size_t quantity, SensorSample sample, Floats& distances);
  template <class Visit>
  void visit_state(Visit visit);

  std::vector<Disturbed> devices_;
  std::vector<Disturbed> joints_;
  std::vector<TrueReading> truths_;
};

}  // namespace rehearse
