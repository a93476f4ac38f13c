// Feeds for devices from a log: inertial and force sensors, cameras, range sensors.
#include <fmt/format.h>
#include <rehearse/messages.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "base/clock.h"
#include "log_feed.h"
#include "log_track.h"
#include "message_reader.h"
#include "sensor_codecs.h"

namespace rehearse {
namespace {

/// The common part of all device feeds: the devices' readings in the robot's body.
class DeviceFeed : public LogFeed {
 public:
  DeviceFeed(const DeviceSource& source, const Model& model) : source_(source), model_(model) {}

 protected:
  const DeviceSource& source() const { return source_; }
  const Device& device(int index) const { return model_.devices[index]; }

 private:
  const DeviceSource& source_;
  const Model& model_;
};

/// Six numbers: for an IMU the angular velocity and the specific force, for a force sensor the force and the torque.
class NumberFeed : public DeviceFeed {
 public:
  NumberFeed(const DeviceSource& source, const Model& model, const ros2msg::Schema& schema)
      : DeviceFeed(source, model), imu_(schema), wrench_(schema) {}

  Result<void> take(std::int64_t time, mcap::Bytes payload) override {
    if (source().kind == DeviceSource::Kind::imu) {
      const msg::Imu* imu = imu_.read(payload);
      if (!imu) return misfit(payload);
      add(time, imu->angular_velocity, imu->linear_acceleration);
    } else {
      const msg::WrenchStamped* wrench = wrench_.read(payload);
      if (!wrench) return misfit(payload);
      add(time, wrench->wrench.force, wrench->wrench.torque);
    }
    return {};
  }

  void look(const LogMoment& moment, Observation& seen) override {
    auto span = track_.at(moment.time, source().sampling == Sampling::interpolate);
    if (!span) return;
    if (span->after && static_cast<double>(span->after->time - span->before->time) * 1e-9 > source().max_age)
      span->after = nullptr;
    std::array<double, 6> v = span->before->values;
    if (span->after)
      for (std::size_t i = 0; i < v.size(); ++i) v[i] = mix(v[i], span->after->values[i], span->fraction);
    const bool fresh = span->after || !shown_ || *shown_ != span->before->time;
    shown_ = span->before->time;
    for (const int index : source().devices) {
      DeviceReading& reading = seen.bodies[0].devices[index];
      reading.fresh = reading.fresh || fresh;
      reading.measured_at = moment.seconds;
      const DeviceKind& kind = device(index).kind;
      if (std::holds_alternative<Accelerometer>(kind)) {
        reading.values = {v[3], v[4], v[5]};
      } else if (std::holds_alternative<Gyro>(kind)) {
        reading.values = {v[0], v[1], v[2]};
      } else {
        reading.values.assign(v.begin(), v.end());
      }
    }
  }

 private:
  void add(std::int64_t time, const msg::Vector3& a, const msg::Vector3& b) {
    track_.add(time, {a.x, a.y, a.z, b.x, b.y, b.z});
  }

  MessageReader<msg::Imu> imu_;
  MessageReader<msg::WrenchStamped> wrench_;
  LogTrack<6> track_;
  std::optional<std::int64_t> shown_;  // time of the message that was delivered last [ns]
};

/// Large messages: stored unchanged, and decoded only if a tick needs them.
class BulkFeed : public DeviceFeed {
 public:
  BulkFeed(const DeviceSource& source, const Model& model, const LogTicks& ticks)
      : DeviceFeed(source, model), ticks_(ticks) {}

  Result<void> take(std::int64_t time, mcap::Bytes payload) override {
    waiting_.push_back({time, {payload.begin(), payload.end()}});
    return {};
  }

  /// Shows the latest message that can be read.
  void look(const LogMoment& moment, Observation& seen) override {
    const auto later =
        std::ranges::find_if(waiting_, [&](const Waiting& message) { return message.time > moment.time; });
    for (auto newest = later; newest != waiting_.begin();) {
      --newest;
      arrived_ = newest->time;
      const auto shown = show(newest->payload, seen);
      if (shown) break;
      unreadable_.push_back({newest->time, shown.errors()[0]});
    }
    waiting_.erase(waiting_.begin(), later);
  }
  std::vector<UnreadableMessage> take_unreadable() override { return std::exchange(unreadable_, {}); }

 protected:
  virtual Result<void> show(const std::vector<std::byte>& payload, Observation& seen) = 0;
  DeviceReading& freshen(Observation& seen, int index) const {
    DeviceReading& reading = seen.bodies[0].devices[index];
    reading.fresh = true;
    reading.measured_at = measured_at_;
    return reading;
  }
  /// Sets the time of measurement: the time in the header, if its clock agrees with the log's; else the time of
  /// arrival.
  void measured(const msg::Header& header) {
    constexpr std::int64_t longest = 1'000'000'000;  // [ns]: a longer delay means that the clocks differ
    std::int64_t age = arrived_ - static_cast<std::int64_t>(header.stamp.to_ns());
    if (source().clock == LogClock::header_stamp || age < 0 || age > longest) age = 0;
    // The time of the nearest tick: exactly the number that a replay of the recording computes.
    measured_at_ = time_of(ticks_.nearest(arrived_ - age), ticks_.time_step());
  }

 private:
  struct Waiting {
    std::int64_t time;
    std::vector<std::byte> payload;
  };

  const LogTicks& ticks_;
  std::int64_t arrived_ = 0;  // time of the present message [ns]
  double measured_at_ = 0.0;  // [s]
  std::vector<UnreadableMessage> unreadable_;
  std::deque<Waiting> waiting_;
};

class PictureFeed : public BulkFeed {
 public:
  PictureFeed(const DeviceSource& source, const Model& model, const LogTicks& ticks, const LogTopic& topic,
              const ros2msg::Schema& schema)
      : BulkFeed(source, model, ticks),
        is_raw_(topic.has("encoding", FieldContent::text)),
        raw_(schema),
        compressed_(schema) {}

 private:
  Result<void> check_size(int width, int height) const {
    for (const int index : source().devices) {
      const auto& camera = std::get<Camera>(device(index).kind);
      if (camera.width != width || camera.height != height)
        return error(fmt::format("pictures of {} x {} pixels, and the model's camera '{}' has {} x {}", width, height,
                                 device(index).name, camera.width, camera.height),
                     "the model's camera has to be the one that was recorded");
    }
    return {};
  }

  Result<void> show(const std::vector<std::byte>& payload, Observation& seen) override {
    const bool is_depth = source().kind == DeviceSource::Kind::depth;
    const msg::Image* raw = is_raw_ ? raw_.read(payload) : nullptr;
    const msg::CompressedImage* compressed = is_raw_ ? nullptr : compressed_.read(payload);
    if (!raw && !compressed) return misfit(payload);
    measured(raw ? raw->header : compressed->header);
    if (is_depth) {
      auto depth = REHEARSE_TRY(depth_of(*raw));
      REHEARSE_TRY(check_size(depth.width, depth.height));
      const auto shared = std::make_shared<const DepthImage>(std::move(depth));
      for (const int index : source().devices) freshen(seen, index).depth = shared;
    } else {
      auto color = REHEARSE_TRY(raw ? color_of(*raw) : color_of(*compressed));
      REHEARSE_TRY(check_size(color.width, color.height));
      if (compressed) color.file = compressed->data;
      const auto shared = std::make_shared<const Image>(std::move(color));
      for (const int index : source().devices) freshen(seen, index).image = shared;
    }
    return {};
  }

  bool is_raw_;
  MessageReader<msg::Image> raw_;
  MessageReader<msg::CompressedImage> compressed_;
};

class RangeFeed : public BulkFeed {
 public:
  RangeFeed(const DeviceSource& source, const Model& model, const LogTicks& ticks, const LogTopic& topic,
            const ros2msg::Schema& schema)
      : BulkFeed(source, model, ticks), is_scan_(topic.has("ranges/*")), scan_(schema), cloud_(schema) {}

  Diagnostics take_remarks() override { return std::exchange(remarks_, {}); }

 private:
  Result<void> show(const std::vector<std::byte>& payload, Observation& seen) override {
    const msg::LaserScan* scan = is_scan_ ? scan_.read(payload) : nullptr;
    const msg::PointCloud2* cloud = is_scan_ ? nullptr : cloud_.read(payload);
    if (!scan && !cloud) return misfit(payload);
    measured(scan ? scan->header : cloud->header);
    for (const int index : source().devices) {
      const auto& sensor = std::get<RangeSensor>(device(index).kind);
      if (scan) compare_angles(*scan, sensor, device(index).name);
      auto ranges = REHEARSE_TRY(scan ? ranges_of(*scan, sensor) : ranges_of(*cloud, sensor));
      freshen(seen, index).ranges = std::make_shared<const std::vector<float>>(std::move(ranges));
    }
    return {};
  }

  /// Adds a remark, once, if the angles differ: beams are matched by their number, independent of their angles.
  void compare_angles(const msg::LaserScan& scan, const RangeSensor& sensor, const std::string& name) {
    const double lower = static_cast<double>(scan.angle_min), step = static_cast<double>(scan.angle_increment);
    const double allowed = std::max(sensor.yaw.step() / 2, 1e-3);
    const double upper = lower + step * (sensor.yaw.samples - 1);
    const bool alike = std::abs(lower - sensor.yaw.lower) <= allowed && std::abs(upper - sensor.yaw.upper) <= allowed;
    if (std::exchange(compared_, true) || alike) return;
    remarks_.push_back(at(
        source().place, warning(fmt::format("the scans on '{}' go from {:.4g} to {:.4g} rad, and the model's '{}' from "
                                            "{:.4g} to {:.4g}",
                                            source().topic, lower, upper, name, sensor.yaw.lower, sensor.yaw.upper),
                                "beams are matched by their numbers")));
  }

  bool is_scan_;
  bool compared_ = false;
  Diagnostics remarks_;
  MessageReader<msg::LaserScan> scan_;
  MessageReader<msg::PointCloud2> cloud_;
};

/// Compares the camera_info messages with the model's camera; controllers don't get them.
class CameraInfoFeed : public DeviceFeed {
 public:
  CameraInfoFeed(const DeviceSource& source, const Model& model, const ros2msg::Schema& schema)
      : DeviceFeed(source, model), reader_(schema) {}

  Result<void> take(std::int64_t, mcap::Bytes payload) override {
    if (compared_) return {};
    const msg::CameraInfo* info = reader_.read(payload);
    if (!info) return misfit(payload);
    compared_ = true;
    for (const int index : source().devices) compare(*info, std::get<Camera>(device(index).kind), device(index).name);
    return {};
  }

  void look(const LogMoment&, Observation&) override {}
  Diagnostics take_remarks() override { return std::exchange(remarks_, {}); }

 private:
  void compare(const msg::CameraInfo& info, const Camera& camera, const std::string& name) {
    const bool is_wide = camera.width >= camera.height;
    const double measured = is_wide ? info.k[4] : info.k[0];  // [pixels]
    const int side = is_wide ? camera.height : camera.width;
    const double focal_length = side / 2.0 / std::tan(camera.field_of_view / 2);  // [pixels]
    constexpr double allowed = 0.02;
    const bool same_size = info.width == static_cast<std::uint32_t>(camera.width) &&
                           info.height == static_cast<std::uint32_t>(camera.height);
    if (same_size && std::abs(measured - focal_length) <= allowed * focal_length) return;
    remarks_.push_back(
        at(source().place,
           warning(fmt::format("the camera of '{}' has {} x {} pixels and a focal length of {:.5g} pixels, and the "
                               "model's '{}' {} x {} and {:.5g}",
                               source().topic, info.width, info.height, measured, name, camera.width, camera.height,
                               focal_length),
                   "a controller gets the values of the model")));
  }

  MessageReader<msg::CameraInfo> reader_;
  bool compared_ = false;
  Diagnostics remarks_;
};

}  // namespace

std::unique_ptr<LogFeed> make_device_feed(const DeviceSource& source, const Model& model, const LogTicks& ticks,
                                          const LogTopic& topic, const ros2msg::Schema& schema) {
  switch (source.kind) {
    case DeviceSource::Kind::imu:
    case DeviceSource::Kind::wrench: return std::make_unique<NumberFeed>(source, model, schema);
    case DeviceSource::Kind::picture:
    case DeviceSource::Kind::depth: return std::make_unique<PictureFeed>(source, model, ticks, topic, schema);
    case DeviceSource::Kind::ranges: return std::make_unique<RangeFeed>(source, model, ticks, topic, schema);
    case DeviceSource::Kind::camera_info: return std::make_unique<CameraInfoFeed>(source, model, schema);
  }
  return nullptr;
}

}  // namespace rehearse
