// The readings of sensors that depend on the motion of their link alone.
#pragma once

#include <rehearse/io.h>
#include <rehearse/model.h>
#include <rehearse/world.h>

#include <Eigen/Geometry>
#include <type_traits>
#include <variant>
#include <vector>

#include "ode_math.h"

namespace rehearse {

/// The axes of the link at the beginning of the step, when the forces acted that changed its velocity.
inline Eigen::Matrix3d axes_before(const LinkReading& link, double time_step) {
  return rotation_before(link.rotation, link.angular_velocity, time_step).toRotationMatrix();
}

template <class Kind, class... Kinds>
concept is_one_of = (std::is_same_v<Kind, Kinds> || ...);

/// Sets the readings of sensors that depend on the motion of their link alone, in the device's frame. A kind of device
/// that has no function here doesn't compile.
class LinkSensor {
 public:
  LinkSensor(const Device& device, const LinkReading& link, const WorldSettings& settings, std::vector<double>& values)
      : link_(link),
        settings_(settings),
        values_(values),
        pose_(device.pose),
        to_sensor_((link.rotation.toRotationMatrix() * device.pose.linear()).transpose()) {}

  void operator()(const Gyro&) const { set(angular_velocity()); }
  void operator()(const Accelerometer&) const { set(specific_force()); }
  void operator()(const Imu&) const {
    const Eigen::Vector3d w = angular_velocity(), f = specific_force();
    values_.assign({w.x(), w.y(), w.z(), f.x(), f.y(), f.z()});
  }
  void operator()(const Magnetometer&) const { set(to_sensor_ * settings_.magnetic_field); }
  /// Kinds that forces, beams or the renderer measure, and those that only act.
  template <class Kind>
  requires is_one_of<Kind, ForceSensor, ContactSensor, Camera, RangeSensor, Light, Rotor, Holder>
  void operator()(const Kind&) const { values_.clear(); }

 private:
  void set(const Eigen::Vector3d& v) const { values_.assign(v.data(), v.data() + 3); }
  Eigen::Vector3d angular_velocity() const { return to_sensor_ * link_.angular_velocity; }
  Eigen::Vector3d specific_force() const {
    const Eigen::Matrix3d axes = axes_before(link_, settings_.time_step);
    Eigen::Vector3d acceleration = link_.acceleration;
    if (settings_.lever_arms && !pose_.translation().isZero(0.0)) {
      const Eigen::Vector3d w_before = link_.angular_velocity - settings_.time_step * link_.angular_acceleration;
      acceleration = acceleration_at(axes * pose_.translation(), acceleration, w_before, link_.angular_acceleration);
    }
    return (axes * pose_.linear()).transpose() * (acceleration - settings_.gravity);
  }

  const LinkReading& link_;
  const WorldSettings& settings_;
  std::vector<double>& values_;
  const Eigen::Isometry3d& pose_;  // of the sensor in the link's frame
  const Eigen::Matrix3d to_sensor_;
};

template <class... Kinds>
constexpr bool has_function_for_each(const std::variant<Kinds...>*) {
  return (std::is_invocable_v<const LinkSensor&, const Kinds&> && ...);
}
static_assert(has_function_for_each(static_cast<const DeviceKind*>(nullptr)),
              "each kind of device has a function of LinkSensor, in engine/src/world/link_sensor.h");

}  // namespace rehearse
