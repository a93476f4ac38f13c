#include "urdf_devices.h"

#include "urdf_draft.h"
#include "urdf_values.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <map>
#include <optional>
#include <string_view>

namespace rehearse::urdf {
namespace {

using tinyxml2::XMLElement;

std::optional<DeviceKind> kind_of_sensor(std::string_view type) {
  if (type == "imu") return Imu{};
  if (type == "accelerometer") return Accelerometer{};
  if (type == "gyroscope" || type == "gyro") return Gyro{};
  if (type == "force_torque") return ForceSensor{};
  if (type == "ray" || type == "gpu_ray" || type == "lidar" || type == "gpu_lidar") return RangeSensor{};
  Camera camera;
  camera.depth = type == "depth" || type == "depth_camera" || type == "rgbd" || type == "rgbd_camera";
  if (camera.depth || type == "camera") return camera;
  return std::nullopt;
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

std::optional<DeviceKind> kind_of(const XMLElement& element) {
  const char* type = element.Attribute("type");
  const bool is_light = std::string_view(element.Name()) == "light";
  if (!is_light) return kind_of_sensor(type == nullptr ? "" : type);
  if (const auto light = light_of_type(type == nullptr ? "" : type)) return *light;
  return std::nullopt;
}

void read_figures(const XMLElement& element, Device& device, Findings& findings) {
  if (auto* camera = std::get_if<Camera>(&device.kind)) {
    report_ignored(element, {"id", "pose", "update_rate", "camera"}, findings);
    read_camera(element, *camera, device.pose, findings);
  } else if (auto* laser = std::get_if<RangeSensor>(&device.kind)) {
    report_ignored(element, {"id", "pose", "update_rate", "ray", "lidar"}, findings);
    read_range_sensor(element, *laser, device.pose, findings);
  } else if (auto* light = std::get_if<Light>(&device.kind)) {
    read_light(element, *light, findings);
  } else {
    report_ignored(element, {"id", "pose"}, findings);
  }
}

/// A <sensor> or <light> of a kind we have; null for others, with a note, and for nameless ones, with an error.
std::optional<DeviceDraft> read_device(const XMLElement& element, const char* reference, Findings& findings) {
  const auto kind = kind_of(element);
  if (!kind) {
    const char* type = element.Attribute("type");
    findings.ignored(element.GetLineNum(), type == nullptr
                                               ? fmt::format("a {} without a type", element.Name())
                                               : fmt::format("a {} of type {}", element.Name(), in_quotes(type)));
    return std::nullopt;
  }
  DeviceDraft draft;
  draft.device.kind = *kind;
  draft.device.line = element.GetLineNum();
  const auto name = read_name(element, "name", findings);
  if (!name) return std::nullopt;
  draft.device.name = *name;
  if (reference == nullptr) {
    findings.error(element.GetLineNum(), fmt::format("{} {} is on no link", element.Name(), in_quotes(*name)),
                   "its <gazebo> names the link: <gazebo reference=\"LINK\">");
    return std::nullopt;
  }
  draft.reference = reference;
  draft.prefers_joint = std::holds_alternative<ForceSensor>(*kind);
  draft.device.id = read_id(element, findings);
  if (const XMLElement* pose = element.FirstChildElement("pose")) draft.device.pose = read_text_pose(*pose, findings);
  read_figures(element, draft.device, findings);
  return draft;
}

/// Kinds that share their ids: a RangeCamera is a Camera, a SpotLight a PointLight.
std::string_view id_group(const Device& device) {
  if (std::holds_alternative<Light>(device.kind)) return "light";
  return std::holds_alternative<Camera>(device.kind) ? "camera" : type_name(device);
}

void report_doubles(const std::vector<DeviceDraft>& devices, Findings& findings) {
  std::map<std::string_view, const Device*> by_name;
  std::map<std::pair<std::string_view, int>, const Device*> by_id;
  for (const DeviceDraft& draft : devices) {
    const Device& device = draft.device;
    if (const auto [first, is_new] = by_name.emplace(device.name, &device); !is_new) {
      const Device& other = *first->second;
      const std::string_view word = word_for(device), others = word_for(other);
      findings.error(device.line, fmt::format("a second {} with the name {}, after the one in line {}",
                                              word == others ? word : "device", in_quotes(device.name), other.line));
    }
    if (device.id < 0) continue;
    if (const auto [first, is_new] = by_id.emplace(std::pair(id_group(device), device.id), &device); !is_new) {
      const std::string_view word = word_for(device);
      findings.error(device.line, fmt::format("{} {} has the id {} of {} {} in line {}", word, in_quotes(device.name),
                                              device.id, word, in_quotes(first->second->name), first->second->line));
    }
  }
}

}  // namespace

void report_ignored(const XMLElement& element, std::initializer_list<std::string_view> known, Findings& findings) {
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    bool is_known = false;
    for (const std::string_view name : known) is_known = is_known || name == child->Name();
    if (!is_known) findings.ignored(child->GetLineNum(), fmt::format("<{}>{}", element.Name(), tag(child->Name())));
  }
}

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

int read_count_or(const XMLElement* element, const char* child, int fallback, int most, Findings& findings) {
  const double value = read_positive_or(element, child, fallback, most, findings);
  if (value != std::floor(value)) {
    findings.error(element->FirstChildElement(child)->GetLineNum(),
                   fmt::format("<{}> is {}, not a whole number", child, value));
    return fallback;
  }
  return static_cast<int>(value);
}

std::string_view word_for(const Device& device) {
  return std::holds_alternative<Light>(device.kind) ? "light" : "sensor";
}

Eigen::Matrix3d device_axes() {
  return (Eigen::Matrix3d() << 0, 0, -1,  //
          -1, 0, 0,                       //
          0, 1, 0)
      .finished();
}

std::vector<DeviceDraft> read_devices(const XMLElement& robot, Findings& findings) {
  std::vector<DeviceDraft> devices;
  for (const auto* block = robot.FirstChildElement("gazebo"); block != nullptr;
       block = block->NextSiblingElement("gazebo")) {
    for (const auto* child = block->FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      const std::string_view what = child->Name();
      if (what != "sensor" && what != "light") continue;
      if (auto draft = read_device(*child, block->Attribute("reference"), findings))
        devices.push_back(std::move(*draft));
    }
  }
  report_doubles(devices, findings);
  return devices;
}

}  // namespace rehearse::urdf
