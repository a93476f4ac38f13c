#include "device_recorder.h"

#include <cmath>
#include <cstring>

#include "core/trace/range_messages.h"
#include "model/pinhole.h"
#include "recorded_image.h"

namespace rehearse {
namespace {

constexpr double no_covariance = -1.0;  // ROS: "this quantity is not measured"

msg::Vector3 vector3_of(const double* v) { return {v[0], v[1], v[2]}; }

msg::Time time_of_capture(const DeviceReading& reading) {
  return msg::Time::from_ns(static_cast<std::uint64_t>(std::llround(reading.measured_at * 1e9)));
}

/// Size and matrices of a pinhole camera without distortion, as sensor_msgs/CameraInfo defines them; the header is
/// empty.
msg::CameraInfo camera_info(const Camera& camera) {
  msg::CameraInfo info;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  const double focal = camera.height / 2.0 / std::tan(vertical_field_of_view(camera) / 2.0);  // [pixels]
  const double cx = camera.width / 2.0;
  const double cy = camera.height / 2.0;
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {focal, 0, cx, 0, focal, cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {focal, 0, cx, 0, 0, focal, cy, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace

std::string scan_frame(const std::string& body, const Device& device) { return body + "/" + device.name + "/scan"; }

DeviceRecorder::DeviceRecorder(TraceOutput& output, const Scenario& scenario, const ScenarioBody& body,
                               const Device& device)
    : device_(&device), frame_(body.name + "/" + device.name) {
  const auto name = [&](ChannelKind kind) { return ChannelName::of_owner(body.name, device.name, kind); };
  if (const auto* laser = std::get_if<RangeSensor>(&device.kind)) {
    frame_ = scan_frame(body.name, device);
    measured_ = is_planar(*laser) ? output.channel<msg::LaserScan>(name(ChannelKind::scan))
                                  : output.channel<msg::PointCloud2>(name(ChannelKind::points));
  } else if (const auto* camera = std::get_if<Camera>(&device.kind)) {
    if (!scenario.record_frames || !scenario.runs_camera(body.name, device.name)) return;
    color_ = output.channel<msg::CompressedImage>(name(ChannelKind::image));
    info_ = output.channel<msg::CameraInfo>(name(ChannelKind::camera_info));
    if (camera->depth) depth_ = output.channel<msg::Image>(name(ChannelKind::depth));
  } else if (std::holds_alternative<ForceSensor>(device.kind)) {
    measured_ = output.channel<msg::WrenchStamped>(name(ChannelKind::wrench));
  } else if (std::holds_alternative<ContactSensor>(device.kind)) {
    measured_ = output.channel<msg::ContactForce>(name(ChannelKind::contact));
  } else if (std::holds_alternative<Light>(device.kind)) {
    measured_ = output.channel<msg::DeviceState>(name(ChannelKind::device_state));
  } else if (value_count(device) > 0) {
    measured_ = output.channel<msg::Imu>(name(ChannelKind::imu));
  }
}

Result<void> DeviceRecorder::write(TraceOutput& output, std::int64_t tick, const DeviceReading& reading) const {
  if (const auto* camera = std::get_if<Camera>(&device_->kind))
    return color_ ? write_pictures(output, tick, *camera, reading) : Result<void>();
  if (const auto* laser = std::get_if<RangeSensor>(&device_->kind)) return write_ranges(output, tick, *laser, reading);
  if (std::holds_alternative<Light>(device_->kind))
    return output.write(measured_, tick, msg::DeviceState{{output.stamp(tick), frame_}, reading.values});
  if (std::holds_alternative<ContactSensor>(device_->kind)) {
    const std::vector<double>& values = reading.values;
    const auto count = static_cast<std::uint32_t>(values[0]);
    return output.write(measured_, tick,
                        msg::ContactForce{{output.stamp(tick), frame_}, count, vector3_of(&values[1])});
  }
  if (!std::holds_alternative<ForceSensor>(device_->kind)) return write_inertial(output, tick, reading);
  msg::WrenchStamped message;
  message.header = {output.stamp(tick), frame_};
  message.wrench = {vector3_of(reading.values.data()), vector3_of(reading.values.data() + 3)};
  return output.write(measured_, tick, message);
}

Result<void> DeviceRecorder::write_inertial(TraceOutput& output, std::int64_t tick,
                                            const DeviceReading& reading) const {
  const bool turns = !std::holds_alternative<Accelerometer>(device_->kind);
  const bool accelerates = !std::holds_alternative<Gyro>(device_->kind);
  msg::Imu message;
  message.header = {output.stamp(tick), frame_};
  message.orientation_covariance[0] = no_covariance;
  message.angular_velocity_covariance[0] = turns ? 0.0 : no_covariance;
  message.linear_acceleration_covariance[0] = accelerates ? 0.0 : no_covariance;
  const double* values = reading.values.data();
  if (turns) message.angular_velocity = vector3_of(values);
  if (accelerates) message.linear_acceleration = vector3_of(turns ? values + 3 : values);
  return output.write(measured_, tick, message);
}

Result<void> DeviceRecorder::write_ranges(TraceOutput& output, std::int64_t tick, const RangeSensor& laser,
                                          const DeviceReading& reading) const {
  const std::vector<float> none;  // the sensor was switched off
  const std::vector<float>& ranges = reading.ranges ? *reading.ranges : none;
  const msg::Header header{time_of_capture(reading), frame_};
  if (is_planar(laser)) {
    msg::LaserScan scan = laser_scan(laser, ranges);
    scan.header = header;
    return output.write(measured_, tick, scan);
  }
  msg::PointCloud2 cloud = point_cloud(laser, ranges);
  cloud.header = header;
  return output.write(measured_, tick, cloud);
}

Result<void> DeviceRecorder::write_pictures(TraceOutput& output, std::int64_t tick, const Camera& camera,
                                            const DeviceReading& reading) const {
  const msg::Header header{time_of_capture(reading), frame_};
  if (auto done = write_color(output, tick, header, reading.image); !done) return done;
  msg::CameraInfo info = camera_info(camera);
  info.header = header;
  if (auto done = output.write(info_, tick, info); !done) return done;
  if (!depth_ || !reading.depth) return {};
  const DepthImage& picture = *reading.depth;
  msg::Image depth;
  depth.header = header;
  depth.width = static_cast<std::uint32_t>(picture.width);
  depth.height = static_cast<std::uint32_t>(picture.height);
  depth.encoding = "32FC1";
  depth.step = depth.width * static_cast<std::uint32_t>(sizeof(float));
  depth.data.resize(picture.meters.size() * sizeof(float));
  std::memcpy(depth.data.data(), picture.meters.data(), depth.data.size());
  return output.write(depth_, tick, depth);
}

/// A picture without a file is encoded while the simulation continues. Null: the camera was switched off.
Result<void> DeviceRecorder::write_color(TraceOutput& output, std::int64_t tick, const msg::Header& header,
                                         const std::shared_ptr<const Image>& image) const {
  if (!image) return output.write(color_, tick, msg::CompressedImage{header, "", {}});
  ++output.size.frames;
  return output.write_later(color_, tick, image->pixels.size() + image->file.size(), raw_picture(header, *image),
                            compose_picture);
}

}  // namespace rehearse
