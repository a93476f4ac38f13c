// Faults: what fails in a test with a ControllerBench, as the `faults:` of a scenario do in a simulation.
//
//   rehearse::BenchOptions options;
//   options.faults.sensor("Imu").stuck({0.1, 0.2})       // from 0.1 s until 0.2 s
//                 .encoder("KNEE").delayed(0.02)         // by 20 ms, in all of the test
//                 .actuator("*_KNEE").weak(0.4, {1.0});  // from 1 s on
//   rehearse::ControllerBench bench("MyWalker", "models/walker.urdf", options);
//
// A name may be a pattern: `*` matches any text. The constructor of ControllerBench reports names that the model
// doesn't have. C++17.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rehearse {

/// The time of a fault: from <= t < until, with the times of ControllerBench::time() [s].
struct FaultTime {
  double from = 0.0;                                       // [s]
  double until = std::numeric_limits<double>::infinity();  // [s]; infinity: to the end
};

/// A list of faults. Parts are named by the functions sensor(), encoder() and actuator(), whose results add a fault
/// each.
class Faults {
 public:
  /// Faults of the readings of a sensor, or of a joint's encoder. Each function adds one fault.
  class OfReadings {
   public:
    Faults& stuck(FaultTime when = {}) const;               // the last sample before is repeated
    Faults& lost(FaultTime when = {}) const;                // there are no readings
    Faults& delayed(double by, FaultTime when = {}) const;  // samples arrive later by this time, 0 to 1 [s]
    /// Readings are off. `quantity`: as in `noise:`, "angular_velocity" of an IMU, "displacement" of an encoder. `by`:
    /// in the quantity's unit, of a quantity with axes along each of them, in the sensor's frame.
    Faults& offset(std::string_view quantity, double by, FaultTime when = {}) const;
    /// Each axis is off by a number of its own.
    Faults& offset(std::string_view quantity, const std::array<double, 3>& by, FaultTime when = {}) const;

   private:
    friend class Faults;
    OfReadings(Faults& faults, std::string part) : faults_(faults), part_(std::move(part)) {}
    Faults& faults_;
    const std::string part_;
  };

  /// Faults of the actuator of a joint. Each function adds one fault. They change BenchJoint::u, q_target and
  /// dq_target, which after a tick are those that act.
  class OfActuator {
   public:
    /// It exerts nothing and the joint turns freely: u is 0, the targets are the joint's q and dq.
    Faults& dead(FaultTime when = {}) const;
    Faults& weak(double effort, FaultTime when = {}) const;  // this share of u is left, 0 to 1
    Faults& reversed(FaultTime when = {}) const;             // commands have the other sign

   private:
    friend class Faults;
    OfActuator(Faults& faults, std::string part) : faults_(faults), part_(std::move(part)) {}
    Faults& faults_;
    const std::string part_;
  };

  OfReadings sensor(std::string_view name);     // the sensors whose names match
  OfReadings encoder(std::string_view joint);   // the readings of the joints whose names match
  OfActuator actuator(std::string_view joint);  // the drives of the joints whose names match

  /// The entries of a list of faults, as a scenario states them: "{sensor: \"Imu\", fault: stuck, from: 0.1}".
  const std::vector<std::string>& entries() const { return entries_; }

 private:
  Faults& add(const std::string& part, const std::string& fault, FaultTime when);

  std::vector<std::string> entries_;
};

}  // namespace rehearse
