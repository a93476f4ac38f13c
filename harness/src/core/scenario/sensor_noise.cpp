#include <rehearse/scenario.h>

#include <algorithm>

namespace rehearse {

const std::array<MeasuredQuantity, joint_quantity_count> joint_quantities{
    {{"displacement", "rad or m", 1}, {"velocity", "rad/s or m/s", 1}, {"effort", "N·m or N", 1}}};

std::vector<MeasuredQuantity> quantities_of(const Device& device) {
  static constexpr MeasuredQuantity angular_velocity{"angular_velocity", "rad/s", 3},
      acceleration{"acceleration", "m/s²", 3}, force{"force", "N", 3}, torque{"torque", "N·m", 3},
      range{"range", "m", 1}, color{"color", "of 255", 1}, depth{"depth", "m", 1};
  struct Lister {
    std::vector<MeasuredQuantity> operator()(const Gyro&) const { return {angular_velocity}; }
    std::vector<MeasuredQuantity> operator()(const Accelerometer&) const { return {acceleration}; }
    std::vector<MeasuredQuantity> operator()(const Imu&) const { return {angular_velocity, acceleration}; }
    std::vector<MeasuredQuantity> operator()(const ForceSensor&) const { return {force, torque}; }
    std::vector<MeasuredQuantity> operator()(const ContactSensor&) const { return {force}; }
    std::vector<MeasuredQuantity> operator()(const RangeSensor&) const { return {range}; }
    std::vector<MeasuredQuantity> operator()(const Light&) const { return {}; }
    std::vector<MeasuredQuantity> operator()(const Rotor&) const { return {}; }
    std::vector<MeasuredQuantity> operator()(const Holder&) const { return {}; }
    std::vector<MeasuredQuantity> operator()(const Camera& camera) const {
      if (camera.depth) return {color, depth};
      return {color};
    }
  };
  return std::visit(Lister{}, device.kind);
}

bool DeviceNoise::changes_nothing() const {
  return dropout == 0.0 &&
         std::all_of(quantities.begin(), quantities.end(), [](const Noise& noise) { return noise.changes_nothing(); });
}

bool JointNoise::changes_nothing() const {
  return std::all_of(quantities.begin(), quantities.end(), [](const Noise& noise) { return noise.changes_nothing(); });
}

bool BodyNoise::disturbs_joints() const {
  return std::any_of(joints.begin(), joints.end(), [](const JointNoise& noise) { return !noise.changes_nothing(); });
}

}  // namespace rehearse
