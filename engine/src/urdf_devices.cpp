#include <rehearse/urdf.h>

#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <string_view>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr double sdf_horizontal_fov = 1.047;  // [rad], SDF's default

/// From SDF's camera axes (x forward, z up) to a Device's (-z forward, y up): its columns are right, up and back.
Eigen::Matrix3d camera_axes() {
  return (Eigen::Matrix3d() << 0, 0, -1,  //
          -1, 0, 0,                       //
          0, 1, 0)
      .finished();
}

/// Counts the children that nobody reads.
void report_ignored(const XMLElement& element, std::initializer_list<std::string_view> known, Findings& findings) {
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    bool is_known = false;
    for (const std::string_view name : known) is_known = is_known || name == child->Name();
    if (!is_known) findings.ignored(child->GetLineNum(), fmt::format("<{}>{}", element.Name(), tag(child->Name())));
  }
}

std::optional<DeviceKind> kind_of(std::string_view type) {
  if (type == "imu") return Imu{};
  if (type == "accelerometer") return Accelerometer{};
  if (type == "gyroscope" || type == "gyro") return Gyro{};
  if (type == "force_torque") return ForceSensor{};
  Camera camera;
  camera.depth = type == "depth" || type == "depth_camera" || type == "rgbd" || type == "rgbd_camera";
  if (camera.depth || type == "camera") return camera;
  return std::nullopt;
}

/// The child's number, or `fallback` if there is no such child; an error unless it is above 0 and at most `most`.
double read_positive_or(const XMLElement* element, const char* child, double fallback, double most,
                        Findings& findings) {
  const XMLElement* place = element == nullptr ? nullptr : element->FirstChildElement(child);
  if (place == nullptr) return fallback;
  const auto value = read_text_number(*place, findings);
  if (!value) return fallback;
  if (*value > 0.0 && *value <= most) return *value;
  findings.error(place->GetLineNum(),
                 std::isfinite(most) ? fmt::format("<{}> is {}; it must be above 0 and at most {}", child, *value, most)
                                     : fmt::format("<{}> is {}; it must be above 0", child, *value));
  return fallback;
}

int read_pixels_or(const XMLElement* image, const char* child, int fallback, Findings& findings) {
  const double value = read_positive_or(image, child, fallback, max_image_side, findings);
  if (value != std::floor(value)) {
    findings.error(image->FirstChildElement(child)->GetLineNum(),
                   fmt::format("<{}> is {}, not a whole number", child, value));
    return fallback;
  }
  return static_cast<int>(value);
}

/// The same angle, seen along the other side of the picture.
double other_field_of_view(double angle, int from, int to) {
  return 2.0 * std::atan(std::tan(angle / 2.0) * to / from);
}

/// Camera::field_of_view from SDF's angle across or from our own upright one.
double read_field_of_view(const XMLElement& element, const Camera& camera, Findings& findings) {
  constexpr double most = 3.1;  // beyond it the picture's plane is all edge
  const bool is_landscape = camera.width >= camera.height;
  const XMLElement* upright = element.FirstChildElement("vertical_fov");
  if (upright != nullptr && element.FirstChildElement("horizontal_fov") != nullptr) {
    findings.error(upright->GetLineNum(), "<vertical_fov> beside <horizontal_fov>", "give one of them");
  }
  if (upright != nullptr) {
    const double angle = read_positive_or(&element, "vertical_fov", 1.0, most, findings);
    return is_landscape ? angle : other_field_of_view(angle, camera.height, camera.width);
  }
  const double angle = read_positive_or(&element, "horizontal_fov", sdf_horizontal_fov, most, findings);
  return is_landscape ? other_field_of_view(angle, camera.width, camera.height) : angle;
}

/// Reads <camera>, and turns `pose` from SDF's camera axes to ours.
void read_camera(const XMLElement& sensor, Camera& camera, Eigen::Isometry3d& pose, Findings& findings) {
  constexpr double any = std::numeric_limits<double>::infinity();
  camera.frame_rate = read_positive_or(&sensor, "update_rate", 30.0, any, findings);
  const XMLElement* element = sensor.FirstChildElement("camera");
  if (element == nullptr) {
    findings.error(sensor.GetLineNum(), fmt::format("camera {} has no <camera>", in_quotes(sensor.Attribute("name"))),
                   "<camera> holds the picture's size, the field of view and the clip distances");
    return;
  }
  report_ignored(*element, {"pose", "horizontal_fov", "vertical_fov", "image", "clip"}, findings);
  if (const XMLElement* inner = element->FirstChildElement("pose")) pose = pose * read_text_pose(*inner, findings);
  pose.linear() = pose.linear() * camera_axes();

  const XMLElement* image = element->FirstChildElement("image");
  camera.width = read_pixels_or(image, "width", 320, findings);
  camera.height = read_pixels_or(image, "height", 240, findings);
  camera.field_of_view = read_field_of_view(*element, camera, findings);

  const XMLElement* clip = element->FirstChildElement("clip");
  camera.near_clip = read_positive_or(clip, "near", 0.1, any, findings);
  camera.far_clip = read_positive_or(clip, "far", 100.0, any, findings);
  if (camera.near_clip >= camera.far_clip) {
    findings.error((clip == nullptr ? element : clip)->GetLineNum(),
                   fmt::format("<near> is {}, not below <far>, which is {}", camera.near_clip, camera.far_clip));
  }
}

int read_id(const XMLElement& sensor, Findings& findings) {
  const XMLElement* element = sensor.FirstChildElement("id");
  if (element == nullptr) return -1;
  const auto value = read_text_number(*element, findings);
  if (!value) return -1;
  constexpr double most = 1e6;
  if (*value < 0.0 || *value > most || *value != std::floor(*value)) {
    findings.error(element->GetLineNum(), fmt::format("the id {} isn't a whole number from 0 to {}", *value, most));
    return -1;
  }
  return static_cast<int>(*value);
}

/// A sensor of a kind we have; null for others, with a note, and for nameless ones, with an error.
std::optional<DeviceDraft> read_sensor(const XMLElement& sensor, const char* reference, Findings& findings) {
  const char* type = sensor.Attribute("type");
  const auto kind = kind_of(type == nullptr ? "" : type);
  if (!kind) {
    const std::string what = type == nullptr ? "a sensor without a type" : "a sensor of type " + in_quotes(type);
    findings.ignored(sensor.GetLineNum(), what);
    return std::nullopt;
  }
  DeviceDraft draft;
  draft.device.kind = *kind;
  draft.device.line = sensor.GetLineNum();
  const auto name = read_name(sensor, "name", findings);
  if (!name) return std::nullopt;
  draft.device.name = *name;
  if (reference == nullptr) {
    findings.error(sensor.GetLineNum(), fmt::format("sensor {} is on no link", in_quotes(*name)),
                   "its <gazebo> names the link: <gazebo reference=\"LINK\">");
    return std::nullopt;
  }
  draft.reference = reference;
  draft.prefers_joint = std::holds_alternative<ForceSensor>(*kind);
  draft.device.id = read_id(sensor, findings);
  if (const XMLElement* pose = sensor.FirstChildElement("pose")) draft.device.pose = read_text_pose(*pose, findings);
  if (auto* camera = std::get_if<Camera>(&draft.device.kind)) {
    report_ignored(sensor, {"id", "pose", "update_rate", "camera"}, findings);
    read_camera(sensor, *camera, draft.device.pose, findings);
  } else {
    report_ignored(sensor, {"id", "pose"}, findings);
  }
  return draft;
}

/// Kinds that share their ids: a RangeCamera is a Camera.
std::string_view id_group(const Device& device) {
  return std::holds_alternative<Camera>(device.kind) ? "camera" : type_name(device);
}

void report_doubles(const std::vector<DeviceDraft>& devices, Findings& findings) {
  std::map<std::string_view, const Device*> by_name;
  std::map<std::pair<std::string_view, int>, const Device*> by_id;
  for (const DeviceDraft& draft : devices) {
    const Device& device = draft.device;
    if (const auto [first, is_new] = by_name.emplace(device.name, &device); !is_new) {
      findings.error(device.line, fmt::format("a second sensor with the name {}, after the one in line {}",
                                              in_quotes(device.name), first->second->line));
    }
    if (device.id < 0) continue;
    if (const auto [first, is_new] = by_id.emplace(std::pair(id_group(device), device.id), &device); !is_new) {
      findings.error(device.line, fmt::format("sensor {} has the id {} of sensor {} in line {}", in_quotes(device.name),
                                              device.id, in_quotes(first->second->name), first->second->line));
    }
  }
}

}  // namespace

std::vector<DeviceDraft> read_devices(const XMLElement& robot, Findings& findings) {
  std::vector<DeviceDraft> devices;
  for (const auto* block = robot.FirstChildElement("gazebo"); block != nullptr;
       block = block->NextSiblingElement("gazebo")) {
    report_ignored(*block, {"sensor", "pseudo_continuous_track"}, findings);
    for (const auto* sensor = block->FirstChildElement("sensor"); sensor != nullptr;
         sensor = sensor->NextSiblingElement("sensor")) {
      if (auto draft = read_sensor(*sensor, block->Attribute("reference"), findings))
        devices.push_back(std::move(*draft));
    }
  }
  report_doubles(devices, findings);
  return devices;
}

}  // namespace rehearse::urdf
