#include "range_messages.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace rehearse {

bool is_planar(const RangeSensor& sensor) { return sensor.pitch.samples == 1 && sensor.pitch.lower == 0.0; }

Eigen::Matrix3d scan_axes() {
  return (Eigen::Matrix3d() << 0, -1, 0,  //
          0, 0, 1,                        //
          -1, 0, 0)
      .finished();
}

msg::LaserScan laser_scan(const RangeSensor& sensor, const std::vector<float>& ranges) {
  msg::LaserScan scan;
  scan.angle_min = static_cast<float>(sensor.yaw.lower);
  scan.angle_max = static_cast<float>(sensor.yaw.upper);
  scan.angle_increment = static_cast<float>(sensor.yaw.step());
  scan.scan_time = static_cast<float>(1.0 / sensor.scan_rate);
  scan.range_min = static_cast<float>(sensor.min_distance);
  scan.range_max = static_cast<float>(sensor.max_distance);
  scan.ranges = ranges;
  return scan;
}

msg::PointCloud2 point_cloud(const RangeSensor& sensor, const std::vector<float>& ranges) {
  constexpr std::uint32_t size = sizeof(float);
  msg::PointCloud2 cloud;
  for (const char* name : {"x", "y", "z", "range"})
    cloud.fields.push_back({name, size * static_cast<std::uint32_t>(cloud.fields.size()), msg::PointField::float32, 1});
  cloud.point_step = size * static_cast<std::uint32_t>(cloud.fields.size());
  cloud.width = ranges.empty() ? 0 : static_cast<std::uint32_t>(sensor.yaw.samples);
  cloud.height = ranges.empty() ? 0 : static_cast<std::uint32_t>(sensor.pitch.samples);
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.resize(ranges.size() * cloud.point_step);
  cloud.is_dense = true;
  const std::vector<Eigen::Vector3d> beams = beam_directions(sensor);
  const Eigen::Matrix3d to_scan = scan_axes().transpose();
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const bool is_hit = std::isfinite(ranges[i]);
    cloud.is_dense = cloud.is_dense && is_hit;
    Eigen::Vector4f point;
    point.head<3>() = (to_scan * beams[i] * static_cast<double>(ranges[i])).cast<float>();
    if (!is_hit) point.head<3>().setConstant(std::numeric_limits<float>::quiet_NaN());
    point[3] = ranges[i];
    std::memcpy(cloud.data.data() + i * cloud.point_step, point.data(), cloud.point_step);
  }
  return cloud;
}

bool read_ranges(const msg::PointCloud2& cloud, std::vector<float>& ranges) {
  const msg::PointField* range = nullptr;
  for (const msg::PointField& field : cloud.fields)
    if (field.name == "range" && field.datatype == msg::PointField::float32) range = &field;
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  if (!range || cloud.is_bigendian || cloud.point_step < sizeof(float) ||
      range->offset > cloud.point_step - sizeof(float) || cloud.row_step != cloud.width * cloud.point_step ||
      cloud.data.size() / cloud.point_step < count)
    return false;
  ranges.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(&ranges[i], cloud.data.data() + i * cloud.point_step + range->offset, sizeof(float));
  return true;
}

}  // namespace rehearse
