#include "sensor_codecs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "picture/picture.h"

namespace rehearse {
namespace {

/// The places of the colours in a pixel.
struct ColorLayout {
  const char* encoding;
  std::size_t bytes;  // per pixel
  std::array<std::size_t, 3> rgb;
};
constexpr ColorLayout color_layouts[] = {{"rgb8", 3, {0, 1, 2}},
                                         {"bgr8", 3, {2, 1, 0}},
                                         {"rgba8", 4, {0, 1, 2}},
                                         {"bgra8", 4, {2, 1, 0}},
                                         {"mono8", 1, {0, 0, 0}}};

/// Fails unless the data has the size of all rows.
Result<void> check_size(const msg::Image& message, std::size_t pixel) {
  if (message.width == 0 || message.height == 0 || message.width > max_picture_side ||
      message.height > max_picture_side)
    return error(fmt::format("a picture of {} x {} pixels", message.width, message.height),
                 fmt::format("expected 1 to {} a side", max_picture_side));
  if (message.step < message.width * pixel || message.data.size() / message.step < message.height)
    return error(fmt::format("a picture of {} x {} pixels in {} has {} bytes, {} a row", message.width, message.height,
                             message.encoding, message.data.size(), message.step));
  return {};
}

/// The numbers of a row in the order of bytes of this machine.
template <class Number>
void read_row(const std::uint8_t* bytes, bool swap, std::vector<Number>& row) {
  std::memcpy(row.data(), bytes, row.size() * sizeof(Number));
  if (!swap) return;
  for (Number& number : row) {
    auto places = std::bit_cast<std::array<std::uint8_t, sizeof(Number)>>(number);
    std::ranges::reverse(places);
    number = std::bit_cast<Number>(places);
  }
}

template <class Number>
Result<DepthImage> distances(const msg::Image& message, float meters) {
  REHEARSE_TRY(check_size(message, sizeof(Number)));
  const bool swap = (message.is_bigendian != 0) != (std::endian::native == std::endian::big);
  DepthImage depth{static_cast<int>(message.width), static_cast<int>(message.height), {}};
  depth.meters.resize(std::size_t{message.width} * message.height);
  std::vector<Number> row(message.width);
  float* pixel = depth.meters.data();
  for (std::size_t y = 0; y < message.height; ++y) {
    read_row(&message.data[y * message.step], swap, row);
    for (const Number raw : row) {
      const float distance = static_cast<float>(raw) * meters;
      const bool is_none = std::isfinite(distance) && distance <= 0.0f;  // NaN and ±inf stay
      *pixel++ = is_none ? std::numeric_limits<float>::infinity() : distance;
    }
  }
  return depth;
}

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

Result<Image> color_of(const msg::Image& message) {
  for (const ColorLayout& layout : color_layouts) {
    if (message.encoding != layout.encoding) continue;
    REHEARSE_TRY(check_size(message, layout.bytes));
    Image image{static_cast<int>(message.width), static_cast<int>(message.height), {}};
    image.pixels.resize(std::size_t{message.width} * message.height * 3);
    std::uint8_t* color = image.pixels.data();
    for (std::size_t y = 0; y < message.height; ++y) {
      const std::uint8_t* pixel = &message.data[y * message.step];
      for (std::size_t x = 0; x < message.width; ++x, pixel += layout.bytes)
        for (const std::size_t at : layout.rgb) *color++ = pixel[at];
    }
    return image;
  }
  return error(fmt::format("a picture in '{}'", message.encoding), "read are rgb8, bgr8, rgba8, bgra8 and mono8");
}

Result<Image> color_of(const msg::CompressedImage& message) {
  if (is_png(message.data) || is_jpeg(message.data)) return decode_picture(message.data);
  return error(fmt::format("a picture in '{}', which is neither JPEG nor PNG", message.format),
               "read are JPEG and PNG");
}

Result<DepthImage> depth_of(const msg::Image& message) {
  if (message.encoding == "32FC1") return distances<float>(message, 1.0f);
  if (message.encoding == "16UC1" || message.encoding == "mono16") return distances<std::uint16_t>(message, 0.001f);
  return error(fmt::format("a depth picture in '{}'", message.encoding), "read are 32FC1 [m] and 16UC1 [mm]");
}

Result<std::vector<float>> ranges_of(const msg::LaserScan& scan, const RangeSensor& sensor) {
  REHEARSE_TRY(check_count(scan.ranges.size(), sensor, "scan"));
  std::vector<float> ranges = scan.ranges;
  for (float& range : ranges)
    range = distance_of(static_cast<double>(range), static_cast<double>(scan.range_min),
                        static_cast<double>(scan.range_max));
  return ranges;
}

Result<std::vector<float>> ranges_of(const msg::PointCloud2& cloud, const RangeSensor& sensor) {
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  REHEARSE_TRY(check_count(count, sensor, "cloud"));
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
