// Devices: sensors, cameras and lights, each with the transform of all nodes above it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"
#include "body_elements.h"

namespace rehearse::body {
namespace {

constexpr double default_field_of_view = 0.785398;  // [rad]
constexpr double default_beam_width = 1.570796;     // [rad]

constexpr double one_degree = std::numbers::pi / 180.0;  // [rad]

/// True for an angle of a file in radians that only is possible in degrees.
bool are_degrees(double angle, double most, const Document& document) {
  return !document.degrees && angle > most && angle * one_degree <= most;
}

void take_degrees(Mapping& keys, const std::string& what, double angle) {
  keys.document().warning(keys.node(),
                          fmt::format("{} can't be {:.6g} rad: {:.6g} degrees are taken", what, angle, angle),
                          "the file states angleUnit: radian");
}

/// The frame in which a camera or range sensor looks along -z with +y up, in the device's own.
Eigen::Matrix3d read_optical_frame(Mapping& keys) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  const std::string frame = keys.text({"optical_frame"}).value_or("gl");
  if (frame == "cv")
    turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
  else if (frame == "robotics")
    turn << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  else if (frame != "gl")
    keys.document().error(keys.node(), fmt::format("the optical frame {} isn't known", in_quotes(frame)),
                          "gl, cv or robotics");
  if (const YamlNode* rotation = keys.find({"optical_frame_rotation"}))
    turn = turn * read_rotation(*rotation, keys.document()).value_or(Eigen::Matrix3d::Identity());
  return turn;
}

/// A number above 0, or an error and `otherwise`.
double read_positive(Mapping& keys, Names names, double otherwise) {
  const double value = keys.soft_number(names, otherwise);
  if (value > 0.0) return value;
  keys.document().error(keys.node(), fmt::format("{} is {}", *names.begin(), value), "above 0");
  return otherwise;
}

int read_side(Mapping& keys, const char* key, int otherwise) {
  const double value = keys.soft_number({key}, otherwise);
  if (value >= 1.0 && value <= max_image_side && value == std::floor(value)) return static_cast<int>(value);
  keys.document().error(keys.node(), fmt::format("{} of a camera is {} pixels", key, value),
                        fmt::format("a whole number from 1 to {}", max_image_side));
  return otherwise;
}

void note_off(Mapping& keys, const std::string& name) {
  if (!keys.flag({"on"}).value_or(true))
    keys.document().note(keys.node(), fmt::format("{} is off in the file; here it is on from the beginning", name));
}

std::optional<DeviceKind> read_camera(Mapping& keys, const std::string& name) {
  Document& document = keys.document();
  Camera camera;
  const std::string format = keys.text({"format"}).value_or("");
  const std::string lens = keys.text({"lens_type", "lensType"}).value_or("NORMAL");
  camera.width = read_side(keys, "width", camera.width);
  camera.height = read_side(keys, "height", camera.height);
  camera.field_of_view = keys.soft_angle({"field_of_view", "fieldOfView"}, default_field_of_view);
  camera.near_clip = read_positive(keys, {"near_clip_distance", "nearClipDistance"}, camera.near_clip);
  camera.far_clip = read_positive(keys, {"far_clip_distance", "farClipDistance"}, camera.far_clip);
  camera.frame_rate = read_positive(keys, {"frame_rate", "frameRate"}, camera.frame_rate);
  note_off(keys, name);
  if (format.empty()) {
    document.warning(keys.node(), fmt::format("{} has no format; it is left out, as in Choreonoid", name),
                     "format: COLOR, DEPTH or COLOR_DEPTH");
    return std::nullopt;
  }
  if (format != "COLOR" && format != "DEPTH" && format != "COLOR_DEPTH" && format != "POINT_CLOUD" &&
      format != "COLOR_POINT_CLOUD") {
    document.error(keys.node(), fmt::format("the format {} of {} isn't known", in_quotes(format), name),
                   "COLOR, DEPTH, COLOR_DEPTH, POINT_CLOUD or COLOR_POINT_CLOUD");
    return std::nullopt;
  }
  if (lens != "NORMAL") {
    document.warning(keys.node(),
                     fmt::format("{} is left out: it has a {} lens, and only NORMAL is drawn", name, lens));
    return std::nullopt;
  }
  if (are_degrees(camera.field_of_view, std::numbers::pi, document)) {
    take_degrees(keys, fmt::format("the field of view of {}", name), camera.field_of_view);
    camera.field_of_view *= one_degree;
  }
  if (!(camera.field_of_view > 0.0 && camera.field_of_view < std::numbers::pi)) {
    document.error(keys.node(), fmt::format("the field of view of {} is {:.6g} rad", name, camera.field_of_view),
                   "above 0 and below pi; by default the file's angles are degrees");
    return std::nullopt;
  }
  if (camera.near_clip >= camera.far_clip) {
    document.error(keys.node(), fmt::format("{} sees from {} to {} m", name, camera.near_clip, camera.far_clip),
                   "near_clip_distance below far_clip_distance");
    return std::nullopt;
  }
  camera.depth = format != "COLOR";
  if (format != "COLOR" && format != "COLOR_DEPTH")
    document.note(keys.node(), fmt::format("{} has the format {}; here it measures colour and depth", name, format));
  return camera;
}

/// One direction of a range sensor: by bounds, or by its full range, with a step or a number of samples.
Sweep read_sweep(Mapping& keys, const std::string& kind, double range_by_default, double step_by_default) {
  const auto key = [&kind](const char* end) { return kind + end; };
  const std::string snake_range = key("_range"), camel_range = key("Range"), snake_step = key("_step"),
                    camel_step = key("Step"), lowest = "min_" + kind + "_angle", highest = "max_" + kind + "_angle",
                    samples = key("_samples");
  const std::string scan_angle = kind == "yaw" ? "scanAngle" : snake_range;
  const std::string scan_step = kind == "yaw" ? "scanStep" : snake_step;
  const double range = keys.soft_angle({snake_range, camel_range, scan_angle}, range_by_default);
  Sweep sweep{-range / 2.0, range / 2.0, 1};
  const auto low = keys.angle({lowest}), high = keys.angle({highest});
  if (low && high) sweep = {*low, *high, 1};
  double whole = sweep.upper - sweep.lower;
  auto step = keys.angle({snake_step, camel_step, scan_step});
  constexpr double full_turn = 2.0 * std::numbers::pi + 1e-9;  // [rad]
  if (are_degrees(whole, full_turn, keys.document())) {
    take_degrees(keys, fmt::format("the {} of a range sensor", kind), whole);
    for (double* angle : {&sweep.lower, &sweep.upper, &whole}) *angle *= one_degree;
    if (step) *step *= one_degree;
  }
  const auto count = keys.number({samples});
  double beams = 1.0;
  if (count && !step)
    beams = *count;
  else if (const double used = step.value_or(step_by_default); used > 0.0)
    beams = std::floor(whole / used + 1e-7) + 1.0;
  constexpr double most = 100'000.0;
  if (!(whole >= 0.0 && whole <= full_turn && beams >= 1.0 && beams <= most)) {
    keys.document().error(keys.node(),
                          fmt::format("the {} of a range sensor is {:.6g} rad in {:.6g} beams", kind, whole, beams),
                          "at most a full turn; by default the file's angles are degrees");
    return {};
  }
  sweep.samples = static_cast<int>(beams);
  if (sweep.samples == 1) sweep.lower = sweep.upper = (sweep.lower + sweep.upper) / 2.0;
  return sweep;
}

DeviceKind read_range_sensor(Mapping& keys, const std::string& name) {
  RangeSensor sensor;
  sensor.yaw = read_sweep(keys, "yaw", 2.0 * std::numbers::pi / 3.0, 1.0);
  sensor.pitch = read_sweep(keys, "pitch", 0.0, 1.0);
  sensor.min_distance = std::max(0.0, keys.soft_number({"min_distance", "minDistance"}, sensor.min_distance));
  sensor.max_distance = read_positive(keys, {"max_distance", "maxDistance"}, sensor.max_distance);
  sensor.scan_rate = read_positive(keys, {"scan_rate", "scanRate", "frame_rate", "frameRate"}, sensor.scan_rate);
  note_off(keys, name);
  return sensor;
}

DeviceKind read_light(Mapping& keys, bool is_spot) {
  Light light;
  light.on = keys.flag({"on"}).value_or(true);
  light.color = keys.vector({"color"}).value_or(Eigen::Vector3d::Ones()).cast<float>();
  light.intensity = static_cast<float>(keys.soft_number({"intensity"}, 1.0));
  const Eigen::Vector3d fading = keys.vector({"attenuation"}).value_or(Eigen::Vector3d::UnitX());
  light.constant = static_cast<float>(fading.x());
  light.linear = static_cast<float>(fading.y());
  light.quadratic = static_cast<float>(fading.z());
  if (!is_spot) return light;
  LightCone cone;
  cone.direction = keys.vector({"direction"}).value_or(cone.direction);
  if (cone.direction.norm() < 1e-9) {
    keys.document().error(keys.node(), "the direction of a SpotLight is zero", "as in [0, 0, -1]");
    cone.direction = -Eigen::Vector3d::UnitZ();
  }
  cone.beam_width = static_cast<float>(keys.soft_angle({"beam_width", "beamWidth"}, default_beam_width));
  cone.cut_off_angle = static_cast<float>(keys.soft_angle({"cut_off_angle", "cutOffAngle"}, default_field_of_view));
  cone.cut_off_exponent = static_cast<float>(keys.soft_number({"cut_off_exponent", "cutOffExponent"}, 1.0));
  light.cone = cone;
  return light;
}

DeviceKind read_holder(Mapping& keys) {
  Holder holder;
  const std::string condition = keys.text({"hold_condition", "holdCondition"}).value_or("distance");
  holder.target = keys.text({"hold_target_name", "holdTargetName"}).value_or("");
  holder.max_distance = read_positive(keys, {"max_hold_distance", "maxHoldDistance"}, holder.max_distance);
  if (condition == "collision")
    holder.condition = Holder::Condition::touch;
  else if (condition == "name")
    holder.condition = Holder::Condition::name;
  return holder;
}

/// Devices that measure nothing and act on nothing here.
bool is_passive(const std::string& type) {
  for (const char* known : {"MarkerDevice", "Attachment", "AttachmentDevice", "Conveyor", "ConveyorDevice", "DigitalIO",
                            "ZmpDevice", "RotorDevice", "Link", "Marker"})
    if (type == known) return true;
  return false;
}

}  // namespace

bool ElementReader::read_device(const std::string& type, Mapping& keys, const Place& place) {
  Document& document = *place.document;
  Place below = place;
  below.transform = place.transform * keys.transform();
  Device device;
  device.name = keys.text({"name"}).value_or("");
  device.line = keys.node().line;
  const double id = keys.soft_number({"id"}, -1.0);
  if (id >= 0.0 && id < 1e9) device.id = static_cast<int>(id);
  const std::string name = fmt::format("{} {}", type, in_quotes(device.name));
  std::optional<DeviceKind> kind;
  bool is_vision = false;
  if ((kind = device_kind_of_body(type))) {
    // its type and place are all of it
  } else if (type == "Camera" || type == "CameraDevice" || type == "RangeCamera") {
    kind = read_camera(keys, name);
    is_vision = true;
  } else if (type == "RangeSensor") {
    kind = read_range_sensor(keys, name);
    is_vision = true;
  } else if (type == "PointLight" || type == "SpotLight") {
    kind = read_light(keys, type == "SpotLight");
  } else if (type == "Holder" || type == "HolderDevice") {
    kind = read_holder(keys);
  } else if (is_passive(type)) {
    document.note(keys.node(), fmt::format("{} has no effect here; it is left out", name));
  } else {
    return false;
  }
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d scale;
  if (!split(below.transform.linear(), rotation, scale))
    document.warning(keys.node(), fmt::format("the frame of {} is sheared; its axes are made right-angled", name));
  device.pose.linear() = is_vision ? Eigen::Matrix3d(rotation * read_optical_frame(keys)) : rotation;
  device.pose.translation() = below.transform.translation();
  read_below(keys, below);
  if (!kind) return true;
  keys.find({"on"});
  for (const char* unused :
       {"max_force", "maxForce", "max_torque", "maxTorque", "max_angular_velocity", "maxAngularVelocity",
        "max_acceleration", "maxAcceleration", "detection_rate", "detectionRate", "error_deviation", "errorDeviation"})
    if (keys.find({unused}) != nullptr) document.passed_over(keys.node(), "a " + type, unused);
  keys.finish({"min_distance", "max_distance"});
  device.kind = *std::move(kind);
  contents_.devices.push_back(std::move(device));
  return true;
}

}  // namespace rehearse::body
