#include "range_codecs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

namespace rehearse {
namespace {

constexpr float none = std::numeric_limits<float>::infinity();

/// NaN (no valid measurement) and ±inf (too near, nothing there; REP 117) stay; other distances outside of the limits
/// count as none.
float distance_of(double distance, double least, double most) {
  if (std::isfinite(distance) && !(distance >= least && distance <= most)) return none;
  return static_cast<float>(distance);
}

constexpr std::uint8_t float64 = 8;  // of PointField

Result<void> check_count(std::size_t count, const RangeSensor& sensor, const char* what) {
  if (count == static_cast<std::size_t>(sensor.beams())) return {};
  return error(fmt::format("a {} of {}, where the sensor has {} beams", what, count, sensor.beams()),
               "the model's sensor has to have as many");
}

/// One number of each point of a cloud.
class PointValues {
 public:
  /// Nullopt: the cloud has no such field, or the field isn't inside of each point.
  static std::optional<PointValues> find(const msg::PointCloud2& cloud, std::string_view name) {
    for (const msg::PointField& field : cloud.fields) {
      if (field.name != name || (field.datatype != msg::PointField::float32 && field.datatype != float64)) continue;
      const std::size_t size = field.datatype == float64 ? 8 : 4;
      if (cloud.point_step < size || field.offset > cloud.point_step - size) return std::nullopt;
      return PointValues(cloud, field.offset, size);
    }
    return std::nullopt;
  }

  double at(std::size_t index) const {
    const std::size_t row = index / cloud_->width, column = index % cloud_->width;
    const std::uint8_t* place = &cloud_->data[row * cloud_->row_step + column * cloud_->point_step + offset_];
    std::array<std::uint8_t, 8> bytes{};
    std::memcpy(bytes.data(), place, size_);
    if (cloud_->is_bigendian != (std::endian::native == std::endian::big))
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size_));
    if (size_ == 8) return std::bit_cast<double>(bytes);
    float value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return static_cast<double>(value);
  }

 private:
  PointValues(const msg::PointCloud2& cloud, std::size_t offset, std::size_t size)
      : cloud_(&cloud), offset_(offset), size_(size) {}

  const msg::PointCloud2* cloud_;
  std::size_t offset_;
  std::size_t size_;
};

/// True if all points are within the data.
bool is_whole(const msg::PointCloud2& cloud) {
  if (cloud.width == 0 || cloud.height == 0 || cloud.point_step == 0) return false;
  const std::uint64_t row = std::uint64_t{cloud.width} * cloud.point_step;
  return cloud.row_step >= row && cloud.data.size() >= std::uint64_t{cloud.height - 1} * cloud.row_step + row;
}

}  // namespace

Result<std::vector<float>> ranges_of(const msg::LaserScan& scan, const RangeSensor& sensor) {
  if (auto fits = check_count(scan.ranges.size(), sensor, "scan"); !fits) return fits.errors();
  std::vector<float> ranges = scan.ranges;
  for (float& range : ranges)
    range = distance_of(static_cast<double>(range), static_cast<double>(scan.range_min),
                        static_cast<double>(scan.range_max));
  return ranges;
}

Result<std::vector<float>> ranges_of(const msg::PointCloud2& cloud, const RangeSensor& sensor) {
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  if (auto fits = check_count(count, sensor, "cloud"); !fits) return fits.errors();
  if (!is_whole(cloud)) return error(fmt::format("a cloud of {} points has {} bytes", count, cloud.data.size()));
  const auto range = PointValues::find(cloud, "range");
  const auto x = PointValues::find(cloud, "x"), y = PointValues::find(cloud, "y"), z = PointValues::find(cloud, "z");
  if (!range && !(x && y && z)) return error("a cloud without x, y and z", "expected them as float32 or float64");
  std::vector<float> ranges(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double distance = range ? range->at(i) : std::hypot(x->at(i), y->at(i), z->at(i));
    ranges[i] = distance_of(distance, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max());
  }
  return ranges;
}

}  // namespace rehearse
