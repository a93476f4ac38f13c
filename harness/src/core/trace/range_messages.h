// Converts measurements of a range sensor to messages of ROS and back.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/model.h>

#include <Eigen/Geometry>
#include <vector>

namespace rehearse {

/// True if all its beams lie in one plane, as for a LaserScan: one row of beams, straight ahead.
bool is_planar(const RangeSensor& sensor);

/// Rotation from the frame of the messages (x forward, z up, as in ROS) to the sensor's device frame (-z forward, y
/// up).
Eigen::Matrix3d scan_axes();

/// `ranges` [m]: one per beam, or none if the sensor was switched off. The header is empty.
msg::LaserScan laser_scan(const RangeSensor& sensor, const std::vector<float>& ranges);

/// The point cloud of any range sensor: a point per beam, row by row, each with x, y, z [m] and range [m], all float32.
/// A beam that hit nothing has NaN for x, y, z and +inf for its range.
msg::PointCloud2 point_cloud(const RangeSensor& sensor, const std::vector<float>& ranges);

/// Reads the ranges that point_cloud() wrote into `ranges`; false if the cloud has none.
bool read_ranges(const msg::PointCloud2& cloud, std::vector<float>& ranges);

}  // namespace rehearse
