// Size and matrices of a camera, with each of its pictures.
#include <cmath>

#include "kind.h"
#include "model/pinhole.h"

namespace rehearse {
namespace {

/// Size and matrices of a pinhole camera without distortion, as sensor_msgs/CameraInfo defines them: the centre of the
/// first pixel is at (0, 0), so that of the picture is half a pixel before half its size.
msg::CameraInfo camera_info(const msg::Header& header, const Camera& camera) {
  msg::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(camera.width);
  info.height = static_cast<std::uint32_t>(camera.height);
  const double focal = camera.height / 2.0 / std::tan(vertical_field_of_view(camera) / 2.0);  // [pixels]
  const double cx = (camera.width - 1) / 2.0;
  const double cy = (camera.height - 1) / 2.0;
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {focal, 0, cx, 0, focal, cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {focal, 0, cx, 0, 0, focal, cy, 0, 0, 0, 1, 0};
  return info;
}

constexpr LogInput camera_info_input{
    .content = LogInput::Content::camera_info, .key = "cameras", .devices = "cameras", .messages = "a CameraInfo"};
constexpr DeviceMeasurement camera_info_measurement{
    .log = camera_info_input,
    .has_capture_time = true,
    .encode = [](const Device& device, const DeviceReading&, const msg::Header& header, DeviceMessage& message) {
      msg::encode(camera_info(header, std::get<Camera>(device.kind)), message.cdr);
      return true;
    }};

}  // namespace

const ChannelForm camera_info_kind{.level = ChannelForm::Level::owner,
                                   .segment = "camera_info",
                                   .type = msg::CameraInfo::type_name,
                                   .schema = msg::schema_text<msg::CameraInfo>,
                                   .stage = Stage::renderer,
                                   .measurement = &camera_info_measurement};

}  // namespace rehearse
