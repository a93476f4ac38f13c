// Makes the CameraInfo message of a camera.
#pragma once

#include <rehearse/messages.h>
#include <rehearse/model.h>

namespace rehearse {

/// Size and matrices of a pinhole camera without distortion, as sensor_msgs/CameraInfo defines them; the header is
/// empty.
msg::CameraInfo camera_info(const Camera& camera);

}  // namespace rehearse
