// NoiseMaker: adds a scenario's noise to true values.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace rehearse {

/// The key of the random numbers of a body's sensor, joint or actuator (`kind`) of that name.
std::uint64_t key_of(std::string_view kind, const std::string& body, const std::string& name, std::uint32_t seed);

class NoiseMaker {
 public:
  /// The scenario must outlive this.
  explicit NoiseMaker(const Scenario& scenario);

  /// Adds noise to the readings of devices in this tick. Must be called once for each tick, in order, with true
  /// readings: cameras and range sensors keep their last capture with its noise.
  void disturb_devices(std::int64_t tick, Observation& observation);

  /// True if the noise of any joint is not zero.
  bool has_joints() const { return !joints_.empty(); }
  /// Adds noise to the readings of joints.
  void disturb_joints(std::int64_t tick, Observation& observation) const;

 private:
  struct NoisyDevice {
    int body = 0;
    int device = 0;
    const Device* description = nullptr;
    const DeviceNoise* noise = nullptr;
    std::uint64_t key = 0;
    DeviceReading last;  // of a camera or range sensor
  };
  struct NoisyJoint {
    int body = 0;
    int id = 0;
    const JointNoise* noise = nullptr;
    std::uint64_t key = 0;
  };

  std::vector<NoisyDevice> devices_;
  std::vector<NoisyJoint> joints_;
};

}  // namespace rehearse
