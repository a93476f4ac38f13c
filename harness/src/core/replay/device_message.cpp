#include "device_message.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>
#include <rehearse/messages.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "core/recording/recorded_image.h"
#include "core/trace/range_messages.h"
#include "model/clock.h"

namespace rehearse {
namespace {

/// See read_device().
class DeviceMessage {
 public:
  DeviceMessage(const Device& device, ChannelKind kind, const mcap::Message& message, double time_step)
      : device_(device), kind_(kind), message_(message), time_step_(time_step) {}

  Result<void> read(DeviceReading& reading) const {
    const auto* laser = std::get_if<RangeSensor>(&device_.kind);
    const bool is_camera = std::holds_alternative<Camera>(device_.kind);
    if (is_camera && kind_ == ChannelKind::image) return read_color(reading);
    const bool fits = laser ? read_ranges(*laser, reading) : is_camera ? read_depth(reading) : read_values(reading);
    return fits ? Result<void>() : mismatch();
  }

 private:
  /// Decodes the message, and sets the sensor's time of measurement, bit for bit the number that was recorded.
  template <class T>
  bool decode(T& message, DeviceReading& reading) const {
    CdrReader reader(message_.data);
    if (!msg::decode(reader, message)) return false;
    const double seconds = static_cast<double>(message.header.stamp.to_ns()) * 1e-9;
    reading.measured_at = time_of(std::llround(seconds / time_step_), time_step_);
    return true;
  }

  bool read_values(DeviceReading& reading) const {
    if (std::holds_alternative<Light>(device_.kind)) {
      msg::DeviceState state;
      if (!decode(state, reading)) return false;
      reading.values = std::move(state.values);
    } else if (std::holds_alternative<ContactSensor>(device_.kind)) {
      msg::ContactForce contact;
      if (!decode(contact, reading)) return false;
      reading.values = {static_cast<double>(contact.count), contact.force.x, contact.force.y, contact.force.z};
    } else if (std::holds_alternative<ForceSensor>(device_.kind)) {
      msg::WrenchStamped wrench;
      if (!decode(wrench, reading)) return false;
      const auto& [force, torque] = wrench.wrench;
      reading.values = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    } else {
      msg::Imu imu;
      if (!decode(imu, reading)) return false;
      const msg::Vector3 &w = imu.angular_velocity, &a = imu.linear_acceleration;
      if (std::holds_alternative<Gyro>(device_.kind)) reading.values = {w.x, w.y, w.z};
      if (std::holds_alternative<Accelerometer>(device_.kind)) reading.values = {a.x, a.y, a.z};
      if (std::holds_alternative<Imu>(device_.kind)) reading.values = {w.x, w.y, w.z, a.x, a.y, a.z};
    }
    return true;
  }

  /// A message of a sensor that was switched off contains no distances.
  bool read_ranges(const RangeSensor& laser, DeviceReading& reading) const {
    std::vector<float> ranges;
    if (kind_ == ChannelKind::scan) {
      msg::LaserScan scan;
      if (!decode(scan, reading)) return false;
      ranges = std::move(scan.ranges);
    } else {
      msg::PointCloud2 cloud;
      if (!decode(cloud, reading) || !rehearse::read_ranges(cloud, ranges)) return false;
    }
    if (!ranges.empty() && ranges.size() != static_cast<std::size_t>(laser.beams())) return false;
    reading.ranges = ranges.empty() ? nullptr : std::make_shared<const std::vector<float>>(std::move(ranges));
    return true;
  }

  Result<void> read_color(DeviceReading& reading) const {
    msg::CompressedImage color;
    if (!decode(color, reading)) return mismatch();
    reading.image = nullptr;
    if (color.data.empty()) {  // the camera was switched off
      reading.depth = nullptr;
      return {};
    }
    auto image = image_of(std::move(color));
    if (!image)
      return error(fmt::format("the picture on {} at {} ns can't be replayed: {}", message_.channel->topic,
                               message_.log_time, image.errors()[0].message),
                   image.errors()[0].hint);
    reading.image = std::make_shared<const Image>(std::move(*image));
    return {};
  }

  bool read_depth(DeviceReading& reading) const {
    msg::Image picture;
    if (!decode(picture, reading)) return false;
    const std::size_t pixels = std::size_t{picture.width} * picture.height;
    if (picture.encoding != "32FC1" || picture.data.size() != pixels * sizeof(float)) return false;
    DepthImage depth{static_cast<int>(picture.width), static_cast<int>(picture.height), std::vector<float>(pixels)};
    std::memcpy(depth.meters.data(), picture.data.data(), picture.data.size());
    reading.depth = std::make_shared<const DepthImage>(std::move(depth));
    return true;
  }

  Diagnostic mismatch() const {
    return error(fmt::format("a message on {} at {} ns is not a measurement of device '{}'", message_.channel->topic,
                             message_.log_time, device_.name));
  }

  const Device& device_;
  const ChannelKind kind_;
  const mcap::Message& message_;
  const double time_step_;
};

}  // namespace

Result<void> read_device(const Device& device, ChannelKind kind, const mcap::Message& message, double time_step,
                         DeviceReading& reading) {
  return DeviceMessage(device, kind, message, time_step).read(reading);
}

}  // namespace rehearse
