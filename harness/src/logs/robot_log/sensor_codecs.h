// Converts pictures, scans and point clouds in ROS messages to the measurements of cameras and range sensors.
#pragma once

#include <rehearse/diagnostic.h>
#include <rehearse/io.h>
#include <rehearse/messages.h>
#include <rehearse/model.h>

#include <vector>

namespace rehearse {

/// From encodings rgb8, bgr8, rgba8, bgra8 (alpha is dropped) and mono8. Fails on others, and on data that is too
/// short.
Result<Image> color_of(const msg::Image& message);

/// From JPEG or PNG, detected by its first bytes. Fails on other formats and on damaged data.
Result<Image> color_of(const msg::CompressedImage& message);

/// From encodings 32FC1 [m] and 16UC1 [mm]; 0 and NaN are no distance and become +inf.
Result<DepthImage> depth_of(const msg::Image& message);

/// A distance for each beam of the sensor [m], +inf for none. NaN and -inf (too near) stay as they are; other values
/// outside of the scan's own range limits count as none. Fails if the scan has a different number of beams.
Result<std::vector<float>> ranges_of(const msg::LaserScan& scan, const RangeSensor& sensor);

/// The distances of a cloud with one point per beam, row by row from the lowest pitch, each row from the lowest yaw.
/// They are its field `range`, else the norm of x, y, z. Fails if it has a different number of points, or none of those
/// fields.
Result<std::vector<float>> ranges_of(const msg::PointCloud2& cloud, const RangeSensor& sensor);

}  // namespace rehearse
