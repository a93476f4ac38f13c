// What the two kinds of a range sensor share: its frame, its elements, and its device for controllers.
#pragma once

#include "kind.h"

namespace rehearse {

inline constexpr ElementGroup range_groups[] = {
    {"angle_min", "rad"}, {"angle_max", "rad"}, {"range_min", "m"}, {"range_max", "m"}, {"ranges", "m"}};

inline constexpr LogInput ranges_input{.content = LogInput::Content::ranges,
                                       .key = "ranges",
                                       .devices = "range sensors",
                                       .messages = "a LaserScan or PointCloud2"};

/// True if all its beams lie in one plane, as for a LaserScan: one row of beams, straight ahead.
inline bool is_planar(const RangeSensor& sensor) { return sensor.pitch.samples == 1 && sensor.pitch.lower == 0.0; }

/// Rotation from the frame of the messages (x forward, z up, as in ROS) to the sensor's device frame (-z forward, y
/// up).
Eigen::Matrix3d scan_axes();

inline constexpr MessageFrame scan_frame{"/scan", scan_axes};

/// The distances of a reading by beam [m]; none if the sensor was switched off.
const std::vector<float>& ranges_of(const DeviceReading& reading);
/// False if their number isn't that of the beams. A message of a sensor that was switched off contains none.
bool set_ranges(const RangeSensor& sensor, std::vector<float> ranges, DeviceReading& reading);

cnoid::Device* make_range_sensor(const Device& device);
void feed_range_sensor(cnoid::Device& target, const Device& device, const DeviceReading& reading, double now);

}  // namespace rehearse
