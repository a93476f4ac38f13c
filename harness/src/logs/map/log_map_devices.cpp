// The sources of a map for devices: inertial sensors, force sensors, cameras and range sensors.
#include <fmt/format.h>

#include "base/names.h"
#include "log_map_parts.h"
#include "map_forms.h"

namespace rehearse {
namespace {

using enum FieldContent;

constexpr double max_age_of_pictures = 1.0;  // the default, also of scans: they come ten times a second [s]

}  // namespace

bool fits(DeviceSource::Kind kind, const Device& device) {
  switch (kind) {
    case DeviceSource::Kind::imu:
      return std::holds_alternative<Imu>(device.kind) || std::holds_alternative<Gyro>(device.kind) ||
             std::holds_alternative<Accelerometer>(device.kind);
    case DeviceSource::Kind::wrench: return std::holds_alternative<ForceSensor>(device.kind);
    case DeviceSource::Kind::picture:
    case DeviceSource::Kind::camera_info: return std::holds_alternative<Camera>(device.kind);
    case DeviceSource::Kind::depth: {
      const auto* camera = std::get_if<Camera>(&device.kind);
      return camera != nullptr && camera->depth;
    }
    case DeviceSource::Kind::ranges: return std::holds_alternative<RangeSensor>(device.kind);
  }
  return false;
}

void LogMapReader::read_device(const YamlNode& node, DeviceSource::Kind kind, std::string_view what,
                               std::vector<int>& devices) {
  const auto name = read_text(findings_, node, "device", "the name of a device of the model");
  if (!name) return;
  std::vector<std::string> fitting;
  for (const Device& device : model_.devices)
    if (fits(kind, device)) fitting.push_back(device.name);
  const int index = model_.find_device(*name);
  if (index < 0) {
    findings_.error(node, fmt::format("the model {} has no device '{}'", model_.name, shortened(*name)),
                    name_hint(*name, fitting, what));
  } else if (!fits(kind, model_.devices[index])) {
    findings_.error(node, fmt::format("'{}' is a {}", *name, type_name(model_.devices[index])),
                    name_hint(*name, fitting, what));
  } else if (const auto [first, is_new] = device_lines_.emplace(std::pair(index, kind), node.line); !is_new) {
    findings_.error(node, fmt::format("the device '{}' has a second source", *name),
                    fmt::format("the first is in line {}", first->second));
  } else {
    devices.push_back(index);
  }
}

/// Reads one device or a list of devices, which all get the same messages.
std::vector<int> LogMapReader::read_devices(const Keys& keys, DeviceSource::Kind kind, std::string_view what) {
  std::vector<int> devices;
  const YamlNode* node = keys.require("device", "the name of a device of the model, or a list of names");
  if (node == nullptr) return devices;
  if (node->kind != YamlNode::Kind::list) {
    read_device(*node, kind, what, devices);
  } else {
    if (node->items.empty())
      findings_.error(*node, "device is an empty list", "expected the name of a device of the model");
    for (const YamlNodePtr& item : read_list(findings_, *node, "device", "a list of names"))
      read_device(*item, kind, what, devices);
  }
  return devices;
}

/// The fields x, y and z of two vectors.
LogMapReader::Needs LogMapReader::two_vectors(std::string_view one, std::string_view other) {
  Needs needs;
  for (const std::string_view vector : {one, other})
    for (const char* axis : {"x", "y", "z"}) needs.emplace_back(fmt::format("{}/{}", vector, axis), number);
  return needs;
}

/// Reads the source of a sensor whose messages are on one topic. `needs`: the fields of each type that fits.
void LogMapReader::read_sensor(const Keys& keys, DeviceSource source, std::string_view devices,
                               const std::vector<Needs>& needs, std::string_view type) {
  source.devices = read_devices(keys, source.kind, devices);
  const YamlNode* topic = keys.require("topic", name_of_topic);
  if (topic != nullptr && find_topic(*topic, "topic", needs, type, source)) map_.devices.push_back(std::move(source));
}

/// Reads the source of a sensor of numbers, which can be interpolated.
void LogMapReader::read_vectors(const BoundForm<DeviceSource>& form, const YamlNode& node, DeviceSource::Kind kind,
                                std::string_view devices, const Needs& needs, std::string_view type) {
  const Keys keys(findings_, node, form);
  if (!keys.is_map()) return;
  DeviceSource source;
  source.kind = kind;
  read_source(form, &keys, source, max_age_of_numbers);
  read_sensor(keys, std::move(source), devices, {needs}, type);
}

void LogMapReader::read_imu(const YamlNode& node) {
  read_vectors(bound_imu_source_form(), node, DeviceSource::Kind::imu, "gyros, accelerometers and IMUs",
               two_vectors("angular_velocity", "linear_acceleration"), "an Imu");
}

void LogMapReader::read_wrench(const YamlNode& node) {
  read_vectors(bound_wrench_source_form(), node, DeviceSource::Kind::wrench, "force sensors",
               two_vectors("wrench/force", "wrench/torque"), "a WrenchStamped");
}

void LogMapReader::read_ranges(const YamlNode& node) {
  const Keys keys(findings_, node, range_source_form());
  if (!keys.is_map()) return;
  DeviceSource source;
  source.kind = DeviceSource::Kind::ranges;
  read_source(bound_range_source_form(), &keys, source, max_age_of_pictures);
  const Needs scan{{"ranges/*", number}, {"range_min", number}, {"range_max", number}};
  const Needs cloud{{"fields/*/name", text}, {"fields/*/offset", number}, {"point_step", number}, {"row_step", number},
                    {"width", number},       {"height", number},          {"data", bytes}};
  read_sensor(keys, std::move(source), "range sensors", {scan, cloud}, "a LaserScan or PointCloud2");
}

void LogMapReader::read_camera(const YamlNode& node) {
  const Keys keys(findings_, node, camera_source_form());
  if (!keys.is_map()) return;
  const YamlNode *picture = keys.find("topic"), *depth = keys.find("depth"), *info = keys.find("info");
  if (!picture && !depth)
    findings_.error(node, "a camera has neither 'topic' nor 'depth'", "expected topic: the name of one with pictures");
  DeviceSource common;
  read_source(bound_camera_source_form(), &keys, common, max_age_of_pictures);
  common.devices = read_devices(keys, depth ? DeviceSource::Kind::depth : DeviceSource::Kind::picture,
                                depth ? "cameras that measure depth" : "cameras");
  const Needs raw{{"encoding", text}, {"width", number}, {"height", number}, {"step", number}, {"data", bytes}};
  const Needs compressed{{"format", text}, {"data", bytes}};
  const Needs figures{{"width", number}, {"height", number}, {"k/*", number}};
  const auto add = [&](const YamlNode* topic, std::string_view label, DeviceSource::Kind kind,
                       const std::vector<Needs>& needs, std::string_view what) {
    if (topic == nullptr) return;
    DeviceSource source = common;
    source.kind = kind;
    if (find_topic(*topic, label, needs, what, source)) map_.devices.push_back(std::move(source));
  };
  add(picture, "topic", DeviceSource::Kind::picture, {raw, compressed}, "an Image or CompressedImage");
  add(depth, "depth", DeviceSource::Kind::depth, {raw}, "an Image");
  common.max_age.reset();  // to report it once
  add(info, "info", DeviceSource::Kind::camera_info, {figures}, "a CameraInfo");
}

}  // namespace rehearse
