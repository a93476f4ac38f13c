#include "pinhole.h"

#include <cmath>
#include <limits>
#include <vector>

namespace rehearse {
namespace {

/// 0 for 0, else infinity with the sign of `side`.
float invalid(double side) {
  if (side == 0.0) return 0.0f;
  return std::copysign(std::numeric_limits<float>::infinity(), static_cast<float>(side));
}

}  // namespace

double vertical_field_of_view(const Camera& camera) {
  if (camera.width >= camera.height) return camera.field_of_view;
  return 2.0 * std::atan(std::tan(camera.field_of_view / 2.0) * camera.height / camera.width);
}

void points_from_depth(const Camera& camera, const DepthImage& depth, std::vector<Eigen::Vector3f>& points) {
  const double half_height = std::tan(vertical_field_of_view(camera) / 2.0);  // of the picture at distance 1
  const double half_width = half_height * camera.width / camera.height;
  std::vector<double> rights(static_cast<std::size_t>(depth.width));  // of the columns, at distance 1
  for (int column = 0; column < depth.width; ++column)
    rights[static_cast<std::size_t>(column)] = ((2.0 * column + 1.0) / depth.width - 1.0) * half_width;
  points.resize(depth.meters.size());
  std::size_t i = 0;
  for (int row = 0; row < depth.height; ++row) {
    const double up = (1.0 - (2.0 * row + 1.0) / depth.height) * half_height;
    for (const double right : rights) {
      const double distance = depth.meters[i];
      if (std::isfinite(distance))
        points[i++] = Eigen::Vector3d(right * distance, up * distance, -distance).cast<float>();
      else
        points[i++] = {invalid(right), invalid(up), std::numeric_limits<float>::infinity()};
    }
  }
}

}  // namespace rehearse
