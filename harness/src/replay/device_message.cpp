#include "device_message.h"

#include <fmt/format.h>
#include <rehearse/cdr.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "model/clock.h"
#include "recording/recorded_image.h"
#include "trace/range_messages.h"

namespace rehearse {

template <class T>
bool DeviceMessage::decode(T& message) const {
  CdrReader reader(message_.data);
  return msg::decode(reader, message);
}

/// The sensor's time of measurement, bit for bit the number that was recorded [s].
double DeviceMessage::measured_at(const msg::Time& stamp) const {
  const double seconds = static_cast<double>(stamp.to_ns()) * 1e-9;
  return time_of(std::llround(seconds / time_step_), time_step_);
}

Diagnostic DeviceMessage::mismatch() const {
  return error(fmt::format("a message on {} at {} ns is not a measurement of device '{}'", message_.channel->topic,
                           message_.log_time, device_.name));
}

Result<void> DeviceMessage::read(DeviceReading& reading) const {
  const auto* laser = std::get_if<RangeSensor>(&device_.kind);
  const bool is_camera = std::holds_alternative<Camera>(device_.kind);
  if (is_camera && kind_ == ChannelKind::image) return read_color(reading);
  const bool fits = laser ? read_ranges(*laser, reading) : is_camera ? read_depth(reading) : read_values(reading);
  return fits ? Result<void>() : mismatch();
}

bool DeviceMessage::read_values(DeviceReading& reading) const {
  if (std::holds_alternative<Light>(device_.kind)) {
    msg::DeviceState state;
    if (!decode(state)) return false;
    reading.values = std::move(state.values);
    reading.measured_at = measured_at(state.header.stamp);
  } else if (std::holds_alternative<ContactSensor>(device_.kind)) {
    msg::ContactForce contact;
    if (!decode(contact)) return false;
    reading.values = {static_cast<double>(contact.count), contact.force.x, contact.force.y, contact.force.z};
    reading.measured_at = measured_at(contact.header.stamp);
  } else if (std::holds_alternative<ForceSensor>(device_.kind)) {
    msg::WrenchStamped wrench;
    if (!decode(wrench)) return false;
    const msg::Wrench& w = wrench.wrench;
    reading.values = {w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z};
    reading.measured_at = measured_at(wrench.header.stamp);
  } else {
    return read_inertial(reading);
  }
  return true;
}

bool DeviceMessage::read_inertial(DeviceReading& reading) const {
  msg::Imu imu;
  if (!decode(imu)) return false;
  const msg::Vector3 &w = imu.angular_velocity, &a = imu.linear_acceleration;
  if (std::holds_alternative<Gyro>(device_.kind)) reading.values = {w.x, w.y, w.z};
  if (std::holds_alternative<Accelerometer>(device_.kind)) reading.values = {a.x, a.y, a.z};
  if (std::holds_alternative<Imu>(device_.kind)) reading.values = {w.x, w.y, w.z, a.x, a.y, a.z};
  reading.measured_at = measured_at(imu.header.stamp);
  return true;
}

/// A message of a sensor that was switched off contains no distances.
bool DeviceMessage::read_ranges(const RangeSensor& laser, DeviceReading& reading) const {
  std::vector<float> ranges;
  if (kind_ == ChannelKind::scan) {
    msg::LaserScan scan;
    if (!decode(scan)) return false;
    reading.measured_at = measured_at(scan.header.stamp);
    ranges = std::move(scan.ranges);
  } else {
    msg::PointCloud2 cloud;
    if (!decode(cloud) || !rehearse::read_ranges(cloud, ranges)) return false;
    reading.measured_at = measured_at(cloud.header.stamp);
  }
  if (!ranges.empty() && ranges.size() != static_cast<std::size_t>(laser.beams())) return false;
  reading.ranges = ranges.empty() ? nullptr : std::make_shared<const std::vector<float>>(std::move(ranges));
  return true;
}

Result<void> DeviceMessage::read_color(DeviceReading& reading) const {
  msg::CompressedImage color;
  if (!decode(color)) return mismatch();
  reading.measured_at = measured_at(color.header.stamp);
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

bool DeviceMessage::read_depth(DeviceReading& reading) const {
  msg::Image picture;
  if (!decode(picture)) return false;
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  if (picture.encoding != "32FC1" || picture.data.size() != pixels * sizeof(float)) return false;
  DepthImage depth{static_cast<int>(picture.width), static_cast<int>(picture.height), std::vector<float>(pixels)};
  std::memcpy(depth.meters.data(), picture.data.data(), picture.data.size());
  reading.depth = std::make_shared<const DepthImage>(std::move(depth));
  return true;
}

}  // namespace rehearse
