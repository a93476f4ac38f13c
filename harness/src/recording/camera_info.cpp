#include "camera_info.h"

#include "model/pinhole.h"

#include <cmath>

namespace rehearse {

msg::CameraInfo camera_info(const Camera& camera) {
  msg::CameraInfo info;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  const double focal = camera.height / 2.0 / std::tan(vertical_field_of_view(camera) / 2.0);  // [pixels]
  const double cx = camera.width / 2.0;
  const double cy = camera.height / 2.0;
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {focal, 0, cx, 0, focal, cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {focal, 0, cx, 0, 0, focal, cy, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace rehearse
