// Sensor noise: how far what controllers read is from the truth, as a scenario's `noise:` has it.
//
// A reading is truth + bias + stddev * n, with n from the standard normal distribution, or it is missing (dropout). n
// is a function of the scenario's seed, the sensor's name, the tick and the number's place in the reading, and of
// nothing else: noise at one sensor changes no other's, and a run that goes on from a checkpoint finds the same.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace rehearse {

/// Something that a sensor or joint measures.
struct MeasuredQuantity {
  std::string_view name;
  std::string_view unit;
  int axes;  // 3: x, y, z, each with a bias of its own; 1: all numbers are alike
};

/// Of a Gyro angular_velocity, of an Accelerometer acceleration, of an Imu both, of a ForceSensor force and torque, of
/// a ContactSensor force, of a RangeSensor range, of a camera color, and depth if it measures it; of lights none.
std::vector<MeasuredQuantity> quantities_of(const Device& device);

/// displacement, velocity and effort. Their unit is "rad or m" and so on.
inline constexpr std::size_t joint_quantity_count = 3;
extern const std::array<MeasuredQuantity, joint_quantity_count> joint_quantities;

/// In the unit of the quantity.
struct Noise {
  double stddev = 0.0;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  // of a quantity without axes: x

  bool changes_nothing() const { return stddev == 0.0 && bias.isZero(0.0); }
};

struct DeviceNoise {
  std::vector<Noise> quantities;  // as quantities_of() has them; empty: none
  /// Share of the readings that don't come, 0 to 1: of the beams of a RangeSensor (they find nothing), of a
  /// RangeCamera's depths (they find nothing); of any other sensor, of its readings as a whole.
  double dropout = 0.0;

  bool changes_nothing() const;
};

struct JointNoise {
  std::array<Noise, joint_quantity_count> quantities;

  bool changes_nothing() const;
};

/// What a scenario's noise does to a body. Empty lists: nothing.
struct BodyNoise {
  std::vector<DeviceNoise> devices;  // by device index
  std::vector<JointNoise> joints;    // by joint id

  /// Whether controllers read any joint otherwise than it is.
  bool disturbs_joints() const;
};

/// The number of the standard normal distribution below which a share of `probability`, above 0 and below 1, lies.
/// M. J. Wichura, Algorithm AS 241: The Percentage Points of the Normal Distribution, Applied Statistics 37 (1988),
/// pp. 477-484, routine PPND16: about 16 digits.
double normal_quantile(double probability);

}  // namespace rehearse
