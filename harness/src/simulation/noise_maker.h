// NoiseMaker: turns what is true into what is read, as a scenario's noise has it.
#pragma once

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace rehearse {

class NoiseMaker {
 public:
  /// The scenario must outlive this.
  explicit NoiseMaker(const Scenario& scenario);

  /// Of the devices, in the readings of this tick. To be called once for each tick, in order, with readings that are
  /// true: cameras and range sensors keep their last capture as it was read.
  void disturb_devices(std::int64_t tick, Observation& observation);

  /// True if the noise of any joint does anything.
  bool has_joints() const { return !joints_.empty(); }
  /// Of the joints.
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
