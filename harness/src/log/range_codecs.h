// Converts scans and point clouds in ROS messages to the distances of a range sensor's beams.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/messages.h>
#include <rehearse/model.h>

#include <vector>

namespace rehearse {

/// A distance for each beam of the sensor [m], +inf for none. NaN and -inf (too near) stay as they are; other values
/// outside of the scan's own range limits count as none. Fails if the scan has a different number of beams.
Result<std::vector<float>> ranges_of(const msg::LaserScan& scan, const RangeSensor& sensor);

/// The distances of a cloud with one point per beam, row by row from the lowest pitch, each row from the lowest yaw.
/// They are its field `range`, else the norm of x, y, z. Fails if it has a different number of points, or none of those
/// fields.
Result<std::vector<float>> ranges_of(const msg::PointCloud2& cloud, const RangeSensor& sensor);

}  // namespace rehearse
