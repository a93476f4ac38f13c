// The measurement of a range sensor with several rows of beams.
#include <cmath>
#include <cstring>
#include <limits>

#include "range_frame.h"
#include "rows.h"

namespace rehearse {
namespace {

/// The point cloud of any range sensor: a point per beam, row by row, each with x, y, z [m] and range [m], all float32.
/// A beam that hit nothing has NaN for x, y, z and +inf for its range.
msg::PointCloud2 point_cloud(const msg::Header& header, const RangeSensor& sensor, const std::vector<float>& ranges) {
  constexpr std::uint32_t size = sizeof(float);
  msg::PointCloud2 cloud;
  cloud.header = header;
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

/// Reads the ranges that point_cloud() wrote into `ranges`; false if the cloud has none.
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

constexpr DeviceMeasurement points_measurement{
    .log = ranges_input,
    .is_of = [](const Device& device) { return !is_planar(std::get<RangeSensor>(device.kind)); },
    .frame = &scan_frame,
    .has_capture_time = true,
    .encode =
        [](const Device& device, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          msg::encode(point_cloud(header, std::get<RangeSensor>(device.kind), ranges_of(reading)), message.cdr);
          return true;
        },
    .decode = [](const Device& device, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::PointCloud2 cloud;
      std::vector<float> ranges;
      CdrReader reader(bytes);
      return msg::decode(reader, cloud) && read_ranges(cloud, ranges) &&
             set_ranges(std::get<RangeSensor>(device.kind), std::move(ranges), reading);
    },
    .make = make_range_sensor,
    .feed = feed_range_sensor};

}  // namespace

const ChannelForm points_kind{.level = ChannelForm::Level::owner,
                              .segment = "points",
                              .type = msg::PointCloud2::type_name,
                              .schema = msg::schema_text<msg::PointCloud2>,
                              .stage = Stage::sensors,
                              .groups = range_groups,
                              // the distances, if each point has one; its position follows from the distance
                              .make_rows =
                                  [](TraceChannel& channel, const std::string&) {
                                    return rows_of<msg::PointCloud2>(
                                        channel, [](const msg::PointCloud2& cloud, RowWriter& row) {
                                          row.put("height", CellKind::unsigned_integer, cloud.height);
                                          row.put("width", CellKind::unsigned_integer, cloud.width);
                                          if (std::vector<float> ranges; read_ranges(cloud, ranges))
                                            row.put_array("ranges", ranges);
                                        });
                                  },
                              .measurement = &points_measurement};

}  // namespace rehearse
