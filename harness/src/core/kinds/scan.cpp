// The measurement of a range sensor with beams in one plane.
#include "range_frame.h"
#include "rows.h"

namespace rehearse {
namespace {

/// `ranges` [m]: one per beam, or none if the sensor was switched off.
msg::LaserScan laser_scan(const msg::Header& header, const RangeSensor& sensor, const std::vector<float>& ranges) {
  msg::LaserScan scan;
  scan.header = header;
  scan.angle_min = static_cast<float>(sensor.yaw.lower);
  scan.angle_max = static_cast<float>(sensor.yaw.upper);
  scan.angle_increment = static_cast<float>(sensor.yaw.step());
  scan.scan_time = static_cast<float>(1.0 / sensor.scan_rate);
  scan.range_min = static_cast<float>(sensor.min_distance);
  scan.range_max = static_cast<float>(sensor.max_distance);
  scan.ranges = ranges;
  return scan;
}

constexpr DeviceMeasurement scan_measurement{
    .log = ranges_input,
    .is_of = [](const Device& device) { return is_planar(std::get<RangeSensor>(device.kind)); },
    .frame = &scan_frame,
    .has_capture_time = true,
    .encode =
        [](const Device& device, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          msg::encode(laser_scan(header, std::get<RangeSensor>(device.kind), ranges_of(reading)), message.cdr);
          return true;
        },
    .decode = [](const Device& device, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::LaserScan scan;
      CdrReader reader(bytes);
      return msg::decode(reader, scan) &&
             set_ranges(std::get<RangeSensor>(device.kind), std::move(scan.ranges), reading);
    },
    .make = make_range_sensor,
    .feed = feed_range_sensor};

}  // namespace

const ChannelForm scan_kind{.level = ChannelForm::Level::owner,
                            .segment = "scan",
                            .type = msg::LaserScan::type_name,
                            .schema = msg::schema_text<msg::LaserScan>,
                            .stage = Stage::sensors,
                            .groups = range_groups,
                            .make_rows =
                                [](TraceChannel& channel, const std::string&) {
                                  return rows_of<msg::LaserScan>(channel,
                                                                 [](const msg::LaserScan& scan, RowWriter& row) {
                                                                   row.put("angle_min", scan.angle_min);
                                                                   row.put("angle_max", scan.angle_max);
                                                                   row.put("range_min", scan.range_min);
                                                                   row.put("range_max", scan.range_max);
                                                                   row.put_array("ranges", scan.ranges);
                                                                 });
                                },
                            .measurement = &scan_measurement};

}  // namespace rehearse
