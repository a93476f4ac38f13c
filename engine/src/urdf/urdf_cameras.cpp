#include "urdf_devices.h"

#include <rehearse/urdf.h>

#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <limits>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr double sdf_horizontal_fov = 1.047;  // [rad], SDF's default
constexpr double widest = 3.1;                // [rad]; a larger angle gives an extremely distorted picture
constexpr double any_number = std::numeric_limits<double>::infinity();

/// Converts an angle along one side of the picture to the angle along the other side.
double other_field_of_view(double angle, int from, int to) {
  return 2.0 * std::atan(std::tan(angle / 2.0) * to / from);
}

/// Camera::field_of_view from SDF's horizontal angle or from the vertical angle.
double read_field_of_view(const XMLElement& element, const Camera& camera, Findings& findings) {
  const bool is_landscape = camera.width >= camera.height;
  const XMLElement* upright = element.FirstChildElement("vertical_fov");
  if (upright != nullptr && element.FirstChildElement("horizontal_fov") != nullptr) {
    findings.error(upright->GetLineNum(), "there are both <vertical_fov> and <horizontal_fov>", "give one of them");
  }
  if (upright != nullptr) {
    const double angle = read_positive_or(&element, "vertical_fov", 1.0, widest, findings);
    return is_landscape ? angle : other_field_of_view(angle, camera.height, camera.width);
  }
  const double angle = read_positive_or(&element, "horizontal_fov", sdf_horizontal_fov, widest, findings);
  return is_landscape ? other_field_of_view(angle, camera.width, camera.height) : angle;
}

}  // namespace

void read_camera(const XMLElement& sensor, const XMLElement& element, Camera& camera, Eigen::Isometry3d& pose,
                 Findings& findings) {
  camera.frame_rate = read_positive_or(&sensor, "update_rate", 30.0, any_number, findings);
  report_ignored(element, {"pose", "horizontal_fov", "vertical_fov", "image", "clip", "shadows"}, findings);
  if (const XMLElement* inner = element.FirstChildElement("pose")) pose = pose * read_text_pose(*inner, findings);
  pose.linear() = pose.linear() * device_axes();

  const XMLElement* image = element.FirstChildElement("image");
  camera.width = read_count_or(image, "width", 320, max_image_side, findings);
  camera.height = read_count_or(image, "height", 240, max_image_side, findings);
  if (const XMLElement* samples = image ? image->FirstChildElement("anti_aliasing") : nullptr)
    camera.antialiasing = read_text_number(*samples, findings).value_or(0.0) > 1.0;
  if (const XMLElement* shadows = element.FirstChildElement("shadows"))
    camera.shadows = read_text_flag(*shadows, findings).value_or(false);
  camera.field_of_view = read_field_of_view(element, camera, findings);

  const XMLElement* clip = element.FirstChildElement("clip");
  camera.near_clip = read_positive_or(clip, "near", 0.1, any_number, findings);
  camera.far_clip = read_positive_or(clip, "far", 100.0, any_number, findings);
  if (camera.near_clip >= camera.far_clip) {
    findings.error((clip == nullptr ? element : *clip).GetLineNum(),
                   fmt::format("<near> is {}, not below <far>, which is {}", camera.near_clip, camera.far_clip));
  }
}

void read_optical_camera(const XMLElement& sensor, const XMLElement& element, Camera& camera, Eigen::Isometry3d& pose,
                         Findings& findings) {
  pose.linear() = pose.linear() * device_axes_of_optical();
  camera.frame_rate = 1.0;  // Choreonoid's default
  if (sensor.Attribute("update_rate") != nullptr)
    camera.frame_rate = read_positive(sensor, "update_rate", any_number, findings).value_or(1.0);
  report_ignored(element, {"image"}, findings);
  const XMLElement& image = *element.FirstChildElement("image");
  camera.depth = camera.depth || image.Attribute("depth_format") != nullptr;
  const auto width = read_count(image, "width", max_image_side, findings);
  const auto height = read_count(image, "height", max_image_side, findings);
  const auto across = read_positive(image, "hfov", widest, findings);
  const auto nearest = read_positive(image, "near", any_number, findings);
  const auto farthest = read_positive(image, "far", any_number, findings);
  if (!width || !height || !across || !nearest || !farthest) return;
  camera.width = *width;
  camera.height = *height;
  camera.field_of_view = *width >= *height ? other_field_of_view(*across, *width, *height) : *across;
  camera.near_clip = *nearest;
  camera.far_clip = *farthest;
  if (camera.near_clip >= camera.far_clip) {
    findings.error(image.GetLineNum(),
                   fmt::format("near is {}, not below far, which is {}", camera.near_clip, camera.far_clip));
  }
}

}  // namespace rehearse::urdf
