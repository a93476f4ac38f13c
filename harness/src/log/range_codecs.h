// Scans and point clouds as ROS sends them, as the distances of a range sensor's beams.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/messages.h>
#include <rehearse/model.h>

#include <vector>

namespace rehearse {

/// A distance for each beam of the sensor, +inf for none: what the scan says is out of its range isn't there. Fails if
/// it has another number of beams.
Result<std::vector<float>> ranges_of(const msg::LaserScan& scan, const RangeSensor& sensor);

/// The same of a cloud with a point a beam, row by row from the lowest pitch, each row from the lowest yaw: its field
/// `range`, else the norm of x, y, z. Fails if it has another number of points, or none of those fields.
Result<std::vector<float>> ranges_of(const msg::PointCloud2& cloud, const RangeSensor& sensor);

}  // namespace rehearse
