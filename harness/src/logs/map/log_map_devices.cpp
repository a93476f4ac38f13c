// The sources of a map for devices: inertial sensors, force sensors, cameras and range sensors.
#include <fmt/format.h>

#include <algorithm>

#include "base/names.h"
#include "log_map_parts.h"
#include "map_forms.h"

namespace rehearse {
namespace {

using enum FieldContent;

constexpr double max_age_of_pictures = 1.0;  // the default, also of scans: they come ten times a second [s]

const LogInput& input_of(LogInput::Content content) {
  const auto inputs = log_inputs();
  return **std::ranges::find(inputs, content, &LogInput::content);
}

}  // namespace

void LogMapReader::read_device(const YamlNode& node, const LogInput& input, std::vector<int>& devices) {
  const auto name = read_text(findings_, node, "device", "the name of a device of the model");
  if (!name) return;
  std::vector<std::string> fitting;
  for (const Device& device : model_.devices)
    if (feeds(input, device)) fitting.push_back(device.name);
  const int index = model_.find_device(*name);
  if (index < 0) {
    findings_.error(node, fmt::format("the model {} has no device '{}'", model_.name, shortened(*name)),
                    name_hint(*name, fitting, input.devices));
  } else if (!feeds(input, model_.devices[index])) {
    findings_.error(node, fmt::format("'{}' is a {}", *name, type_name(model_.devices[index])),
                    name_hint(*name, fitting, input.devices));
  } else if (const auto [first, is_new] = device_lines_.emplace(std::pair(index, input.content), node.line); !is_new) {
    findings_.error(node, fmt::format("the device '{}' has a second source", *name),
                    fmt::format("the first is in line {}", first->second));
  } else {
    devices.push_back(index);
  }
}

/// Reads one device or a list of devices, which all get the same messages.
std::vector<int> LogMapReader::read_devices(const Keys& keys, const LogInput& input) {
  std::vector<int> devices;
  const YamlNode* node = keys.require("device", "the name of a device of the model, or a list of names");
  if (node == nullptr) return devices;
  if (node->kind != YamlNode::Kind::list) {
    read_device(*node, input, devices);
  } else {
    if (node->items.empty())
      findings_.error(*node, "device is an empty list", "expected the name of a device of the model");
    for (const YamlNodePtr& item : read_list(findings_, *node, "device", "a list of names"))
      read_device(*item, input, devices);
  }
  return devices;
}

/// Reads the source of a sensor whose messages are on one topic. `needs`: the fields of each type that fits.
void LogMapReader::read_sensor(const Keys& keys, DeviceSource source, const std::vector<Needs>& needs) {
  source.devices = read_devices(keys, *source.input);
  const YamlNode* topic = keys.require("topic", name_of_topic);
  if (topic != nullptr && find_topic(*topic, "topic", needs, source.input->messages, source))
    map_.devices.push_back(std::move(source));
}

/// Reads the source of a sensor of numbers, the elements of its kind.
void LogMapReader::read_numbers_source(const YamlNode& node, const LogInput& input) {
  const BoundForm<DeviceSource>& form = bound_number_source_form(input);
  const Keys keys(findings_, node, form);
  if (!keys.is_map()) return;
  DeviceSource source;
  source.input = &input;
  read_source(form, &keys, source, max_age_of_numbers);
  Needs needs;
  for (const std::string& field : fields_of(input)) needs.emplace_back(field, number);
  read_sensor(keys, std::move(source), {needs});
}

void LogMapReader::read_device_source(const YamlNode& node, const LogInput& input) {
  switch (input.content) {
    case LogInput::Content::numbers: return read_numbers_source(node, input);
    case LogInput::Content::picture: return read_camera(node);
    case LogInput::Content::ranges: return read_ranges(node, input);
    case LogInput::Content::depth:
    case LogInput::Content::camera_info:  // keys of a camera
    case LogInput::Content::none: return;
  }
}

void LogMapReader::read_ranges(const YamlNode& node, const LogInput& input) {
  const Keys keys(findings_, node, range_source_form());
  if (!keys.is_map()) return;
  DeviceSource source;
  source.input = &input;
  read_source(bound_range_source_form(), &keys, source, max_age_of_pictures);
  const Needs scan{{"ranges/*", number}, {"range_min", number}, {"range_max", number}};
  const Needs cloud{{"fields/*/name", text}, {"fields/*/offset", number}, {"point_step", number}, {"row_step", number},
                    {"width", number},       {"height", number},          {"data", bytes}};
  read_sensor(keys, std::move(source), {scan, cloud});
}

void LogMapReader::read_camera(const YamlNode& node) {
  const Keys keys(findings_, node, camera_source_form());
  if (!keys.is_map()) return;
  const YamlNode *picture = keys.find("topic"), *depth = keys.find("depth"), *info = keys.find("info");
  if (!picture && !depth)
    findings_.error(node, "a camera has neither 'topic' nor 'depth'", "expected topic: the name of one with pictures");
  DeviceSource common;
  read_source(bound_camera_source_form(), &keys, common, max_age_of_pictures);
  const LogInput &of_picture = input_of(LogInput::Content::picture), &of_depth = input_of(LogInput::Content::depth);
  common.devices = read_devices(keys, depth ? of_depth : of_picture);
  const Needs raw{{"encoding", text}, {"width", number}, {"height", number}, {"step", number}, {"data", bytes}};
  const Needs compressed{{"format", text}, {"data", bytes}};
  const Needs figures{{"width", number}, {"height", number}, {"k/*", number}};
  const auto add = [&](const YamlNode* topic, std::string_view label, const LogInput& input,
                       const std::vector<Needs>& needs) {
    if (topic == nullptr) return;
    DeviceSource source = common;
    source.input = &input;
    if (find_topic(*topic, label, needs, input.messages, source)) map_.devices.push_back(std::move(source));
  };
  add(picture, "topic", of_picture, {raw, compressed});
  add(depth, "depth", of_depth, {raw});
  common.max_age.reset();  // to report it once
  add(info, "info", input_of(LogInput::Content::camera_info), {figures});
}

}  // namespace rehearse
