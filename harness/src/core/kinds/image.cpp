// The colour pictures of a camera, and the camera for controllers.
#include <algorithm>
#include <cnoid/RangeCamera>
#include <memory>

#include "kind.h"
#include "model/pinhole.h"
#include "recorded_image.h"

namespace rehearse {
namespace {

constexpr ElementGroup image_groups[] = {{"", "pixels"}};

cnoid::Device* make_camera(const Device& device) {
  const auto& camera = std::get<Camera>(device.kind);
  cnoid::Camera* made = camera.depth ? new cnoid::RangeCamera : new cnoid::Camera;
  made->setImageType(cnoid::Camera::COLOR_IMAGE);
  made->setResolution(camera.width, camera.height);
  made->setFieldOfView(camera.field_of_view);
  made->setNearClipDistance(camera.near_clip);
  made->setFarClipDistance(camera.far_clip);
  made->setFrameRate(camera.frame_rate);
  return made;
}

void feed_camera(cnoid::Device& target, const Device& device, const DeviceReading& reading, double now) {
  auto& camera = static_cast<cnoid::Camera&>(target);
  if (!reading.image) {
    camera.clearState();
    return;
  }
  const auto image = std::make_shared<cnoid::Image>();
  image->setSize(reading.image->width, reading.image->height, 3);
  std::ranges::copy(reading.image->pixels, image->pixels());
  std::shared_ptr<cnoid::Image> handed = image;
  camera.setImage(handed);
  camera.setDelay(now - reading.measured_at);
  auto* range_camera = dynamic_cast<cnoid::RangeCamera*>(&camera);
  if (!range_camera || !reading.depth) return;
  auto points = std::make_shared<cnoid::RangeCamera::PointData>();
  points_from_depth(std::get<Camera>(device.kind), *reading.depth, *points);
  range_camera->setPoints(points);
}

constexpr LogInput picture_input{.content = LogInput::Content::picture,
                                 .key = "cameras",
                                 .devices = "cameras",
                                 .messages = "an Image or CompressedImage"};
constexpr DeviceMeasurement image_measurement{
    .log = picture_input,
    .has_capture_time = true,
    // a picture without a file is encoded while the simulation continues
    .encode =
        [](const Device&, const DeviceReading& reading, const msg::Header& header, DeviceMessage& message) {
          if (!reading.image) {  // the camera was switched off
            msg::encode(msg::CompressedImage{header, "", {}}, message.cdr);
            return true;
          }
          if (!reading.image->file.empty()) {
            msg::encode(message_of(header, *reading.image), message.cdr);
            return true;
          }
          message.raw = raw_picture(header, *reading.image);
          message.compose = compose_picture;
          message.held = reading.image->pixels.size() + reading.image->file.size();
          return true;
        },
    .decode = [](const Device&, mcap::Bytes bytes, DeviceReading& reading) -> Result<bool> {
      msg::CompressedImage message;
      CdrReader reader(bytes);
      if (!msg::decode(reader, message)) return false;
      reading.image = nullptr;
      if (message.data.empty()) {  // the camera was switched off
        reading.depth = nullptr;
        return true;
      }
      auto image = REHEARSE_TRY(image_of(std::move(message)));
      reading.image = std::make_shared<const Image>(std::move(image));
      return true;
    },
    .make = make_camera,
    .feed = feed_camera};

}  // namespace

const ChannelForm image_kind{.level = ChannelForm::Level::owner,
                             .segment = "image",
                             .type = msg::CompressedImage::type_name,
                             .schema = msg::schema_text<msg::CompressedImage>,
                             .stage = Stage::renderer,
                             .groups = image_groups,
                             .has_series = false,
                             .chunks = mcap::pictures,
                             .measurement = &image_measurement};

}  // namespace rehearse
