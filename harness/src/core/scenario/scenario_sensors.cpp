#include <rehearse/body.h>

#include "base/names.h"
#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace rehearse {
namespace {

constexpr double a_turn = 6.3, straight_up = 1.6;  // [rad], a little more than 2 pi and pi / 2, for rounded numbers
constexpr int most_beams = 1'000'000;              // of one sensor

/// A sensor of a scenario looks along x with z up, a device along -z with y up.
Eigen::Matrix3d looking_along_x() {
  return (Eigen::Matrix3d() << 0, 0, -1,  //
          -1, 0, 0,                       //
          0, 1, 0)
      .finished();
}

/// Camera::field_of_view of the horizontal angle.
double field_of_view_of(double horizontal, const Camera& camera) {
  if (camera.width < camera.height) return horizontal;
  return 2.0 * std::atan(std::tan(horizontal / 2.0) * camera.height / camera.width);
}

/// A pose while it is read.
struct PoseKeys {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

const BoundForm<PoseKeys>& bound_pose_form() {
  static const BoundForm<PoseKeys> form{
      "pose",
      "a pose",
      {{"position", &PoseKeys::position, any_position, "in the frame of the link [m]"},
       FormKey{"rotation", rotation_type(), "[roll, pitch, yaw], {axis, angle} or {quaternion}"}}};
  return form;
}

/// Whether sensors of the kind have more keys than all have.
bool has_own_keys(const DeviceKind& kind) {
  return std::holds_alternative<ContactSensor>(kind) || std::holds_alternative<Camera>(kind) ||
         std::holds_alternative<RangeSensor>(kind);
}

/// The types of the sensors of some kinds.
std::vector<std::string> types_of(const std::function<bool(const DeviceKind&)>& is_wanted) {
  std::vector<std::string> types_of_sensors;
  for (const DeviceKind& kind : device_kinds())
    if (is_wanted(kind) && !scenario_type(kind).empty()) types_of_sensors.emplace_back(scenario_type(kind));
  return types_of_sensors;
}
template <class Kind>
std::vector<std::string> types_of() {
  return types_of([](const DeviceKind& kind) { return std::holds_alternative<Kind>(kind); });
}

/// The keys of all sensors, and those of a type.
template <class Settings>
std::vector<BoundKey<Settings>> with_common(std::vector<std::string> types_of_sensors,
                                            std::vector<BoundKey<Settings>> keys = {}) {
  std::vector<BoundKey<Settings>> all{
      FormKey{"name", types::name(), "names its channels; unique among the devices of the body", required},
      FormKey{"type", types::word(std::move(types_of_sensors)), "the type of the sensor", required},
      FormKey{"link", types::text(), "the link on which it is; of force the one behind the measured joint", required},
      FormKey{"pose", types::of(pose_form), "in the frame of the link"}};
  all.insert(all.end(), keys.begin(), keys.end());
  return all;
}

/// The key of a sensor with a rate of its own.
template <class Settings>
BoundKey<Settings> rate_key(double Settings::*rate) {
  return {"rate", rate, types::quantity(rate_units, any_reading_rate), "of measurements [Hz]"};
}

/// A camera while it is read.
struct CameraKeys : Camera {
  double horizontal_fov = 1.047;  // [rad], SDF's default
};

const BoundForm<CameraKeys>& bound_camera_form() {
  constexpr Range any_side{1, max_image_side};
  constexpr Range any_distance{0.0, 1e6, "[m]", true};
  static const BoundForm<CameraKeys> form{
      "camera", "a camera",
      with_common<CameraKeys>(types_of<Camera>(),
                              {rate_key<CameraKeys>(&CameraKeys::frame_rate),
                               {"width", &CameraKeys::width, any_side, "[pixels]"},
                               {"height", &CameraKeys::height, any_side, "[pixels]"},
                               {"horizontal_fov", &CameraKeys::horizontal_fov,
                                types::quantity(angle_units, {0.0, 3.1, "[rad]", true}), "field of view [rad]"},
                               {"near", &CameraKeys::near_clip, any_distance, "nothing nearer is drawn; below far [m]"},
                               {"far", &CameraKeys::far_clip, any_distance, "nothing farther is drawn [m]"},
                               {"shadows", &CameraKeys::shadows, "the sun's shadows are drawn"},
                               {"antialiasing", &CameraKeys::antialiasing, "edges are smooth"}})};
  return form;
}

const BoundForm<RangeSensor>& bound_range_sensor_form() {
  constexpr Range any_distance{0.0, 1e6, "[m]"};
  static const BoundForm<RangeSensor> form{
      "range_sensor", "a range sensor",
      with_common<RangeSensor>(
          types_of<RangeSensor>(),
          {rate_key(&RangeSensor::scan_rate),
           FormKey{"yaw", types::of(sweep_form), "of the beams, left is positive; default: one beam, straight ahead"},
           FormKey{"pitch", types::of(sweep_form),
                   "of the beams, up is positive, within ±1.6 rad; default: one beam, straight ahead"},
           {"min", &RangeSensor::min_distance, any_distance, "beams pass through nearer shapes; below max [m]"},
           {"max", &RangeSensor::max_distance, any_distance, "beams end here [m]"}})};
  return form;
}

const BoundForm<Sweep>& bound_sweep_form() {
  const ValueType angle = types::quantity(angle_units, {-a_turn, a_turn, "[rad]"});
  static const BoundForm<Sweep> form{"sweep",
                                     "a sweep",
                                     {FormKey{"from", angle, "angle of the first beam [rad]", required},
                                      FormKey{"to", angle, "angle of the last beam [rad]", required},
                                      {"samples", &Sweep::samples, {1, most_beams}, "number of beams"}}};
  return form;
}

class SensorReader {
 public:
  SensorReader(Findings& findings, ScenarioBody& body) : findings_(findings), body_(body), model_(*body.model) {}

  void read(const YamlNode& node);
  Model take() { return std::move(model_); }

 private:
  using Read = void (SensorReader::*)(const Keys&, Device&);
  /// A type of sensors, and the reader of the keys that not all sensors have; null: it has none.
  struct Type {
    std::string_view name;
    DeviceKind kind;
    Read read;
  };
  static const std::vector<Type>& types();
  static std::vector<std::string> type_names();
  static Read reader_of(const DeviceKind& kind);

  const Type* find_type(const YamlNode& node);
  void read_name(const Keys& keys, Device& device);
  bool read_link(const Keys& keys, Device& device);
  void read_pose(const YamlNode& node, Device& device);
  void read_camera(const Keys& keys, Device& device);
  void read_range(const Keys& keys, Device& device);
  std::optional<Sweep> read_sweep(const YamlNode& node, std::string_view label, double most_angle);
  void read_contact(const Keys& keys, Device& device);
  void check_force(const Keys& keys, Device& device);

  Findings& findings_;
  ScenarioBody& body_;
  Model model_;
};

const std::vector<SensorReader::Type>& SensorReader::types() {
  static const std::vector<Type> all = [] {
    std::vector<Type> types;
    for (const DeviceKind& kind : device_kinds())
      if (!scenario_type(kind).empty()) types.push_back({scenario_type(kind), kind, reader_of(kind)});
    return types;
  }();
  return all;
}

SensorReader::Read SensorReader::reader_of(const DeviceKind& kind) {
  if (std::holds_alternative<ForceSensor>(kind)) return &SensorReader::check_force;
  if (std::holds_alternative<ContactSensor>(kind)) return &SensorReader::read_contact;
  if (std::holds_alternative<Camera>(kind)) return &SensorReader::read_camera;
  if (std::holds_alternative<RangeSensor>(kind)) return &SensorReader::read_range;
  return nullptr;
}

std::vector<std::string> SensorReader::type_names() {
  std::vector<std::string> names;
  for (const Type& type : types()) names.emplace_back(type.name);
  return names;
}

const SensorReader::Type* SensorReader::find_type(const YamlNode& node) {
  for (const Type& type : types())
    if (node.kind == YamlNode::Kind::scalar && node.text == type.name) return &type;
  findings_.error(node, fmt::format("there is no type '{}' of sensors", shortened(node.text)),
                  name_hint(node.text, type_names(), "types"));
  return nullptr;
}

void SensorReader::read(const YamlNode& node) {
  const YamlNode* type_node = node.kind == YamlNode::Kind::map ? find_key(node, "type") : nullptr;
  const Type* type = type_node ? find_type(*type_node) : nullptr;
  if (type_node && !type) return;
  const Keys keys(findings_, node, type ? form_of_sensor(type->kind) : sensor_form());
  if (!keys.is_map()) return;
  Device device;
  read_name(keys, device);
  if (!type_node) keys.require("type", fmt::format("one of {}", fmt::join(type_names(), ", ")));
  const bool has_link = read_link(keys, device);
  if (const YamlNode* pose = keys.find("pose")) read_pose(*pose, device);
  if (!type) return;
  device.kind = type->kind;
  if (type->read && has_link) (this->*type->read)(keys, device);
  if (has_link) model_.devices.push_back(std::move(device));
}

void SensorReader::read_name(const Keys& keys, Device& device) {
  const YamlNode* node = keys.require("name", "a name, unique among the devices of the body");
  const auto name = node ? rehearse::read_name(findings_, *node, "name") : std::nullopt;
  if (!name) return;
  device.name = *name;
  const int same = model_.find_device(*name);
  if (same < 0) return;
  const bool is_of_file = static_cast<std::size_t>(same) < body_.model->devices.size();
  findings_.error(*node, fmt::format("a second device of {} is named '{}'", body_.name, *name),
                  is_of_file ? "the first is in the model's file" : "the first is a sensor above");
}

bool SensorReader::read_link(const Keys& keys, Device& device) {
  const YamlNode* node = keys.require("link", "the link on which it is");
  const auto name = node ? read_text(findings_, *node, "link", "the name of a link") : std::nullopt;
  const auto link = name ? find_link(findings_, *node, *name, body_) : std::nullopt;
  device.link = link.value_or(0);
  return link.has_value();
}

void SensorReader::read_pose(const YamlNode& node, Device& device) {
  const Keys keys(findings_, node, pose_form());
  PoseKeys pose;
  bound_pose_form().read(keys, pose);
  device.pose.translation() = pose.position;
  if (const YamlNode* rotation = keys.find("rotation"))
    if (const auto turn = read_rotation(findings_, *rotation, "rotation"))
      device.pose.linear() = turn->toRotationMatrix();
}

void SensorReader::read_camera(const Keys& keys, Device& device) {
  CameraKeys camera{std::get<Camera>(device.kind)};
  device.pose.linear() = device.pose.linear() * looking_along_x();
  bound_camera_form().read(keys, camera);
  camera.field_of_view = field_of_view_of(camera.horizontal_fov, camera);
  device.kind = static_cast<const Camera&>(camera);
  if (camera.near_clip < camera.far_clip) return;
  const YamlNode* node = keys.find("near");
  findings_.error(node ? *node : *keys.find("far"),
                  fmt::format("near is {}, not below far, which is {}", camera.near_clip, camera.far_clip),
                  "expected near below far");
}

std::optional<Sweep> SensorReader::read_sweep(const YamlNode& node, std::string_view label, double most_angle) {
  const Keys keys(findings_, node, sweep_form());
  Sweep sweep;
  const Range angles{-most_angle, most_angle, "[rad]"};
  const auto read = [&](std::string_view key, double& angle) {
    const YamlNode* value = keys.require(key, "an angle, as -90 deg");
    const auto number = value ? read_quantity(findings_, *value, key, angle_units, angles) : std::nullopt;
    angle = number.value_or(0.0);
    return number.has_value();
  };
  const bool is_read = read("from", sweep.lower) && read("to", sweep.upper);
  bound_sweep_form().read(keys, sweep);
  if (!is_read) return std::nullopt;
  if (sweep.lower > sweep.upper || (sweep.samples > 1 && sweep.lower == sweep.upper)) {
    findings_.error(node, fmt::format("{} goes from {} to {} rad", label, sweep.lower, sweep.upper),
                    "expected from below to, or one sample");
    return std::nullopt;
  }
  if (sweep.samples == 1) sweep.lower = sweep.upper = 0.5 * (sweep.lower + sweep.upper);
  return sweep;
}

void SensorReader::read_range(const Keys& keys, Device& device) {
  auto& laser = std::get<RangeSensor>(device.kind);
  device.pose.linear() = device.pose.linear() * looking_along_x();
  bound_range_sensor_form().read(keys, laser);
  if (const YamlNode* yaw = keys.find("yaw")) laser.yaw = read_sweep(*yaw, "yaw", a_turn).value_or(laser.yaw);
  if (const YamlNode* pitch = keys.find("pitch"))
    laser.pitch = read_sweep(*pitch, "pitch", straight_up).value_or(laser.pitch);
  const double beams = static_cast<double>(laser.yaw.samples) * laser.pitch.samples;
  if (beams > most_beams)
    findings_.error(*keys.find("name"), fmt::format("'{}' has {} beams", device.name, beams),
                    fmt::format("expected at most {}", most_beams));
  if (laser.min_distance < laser.max_distance) return;
  const YamlNode* node = keys.find("min");
  findings_.error(node ? *node : *keys.find("max"),
                  fmt::format("min is {}, not below max, which is {}", laser.min_distance, laser.max_distance),
                  "expected min below max");
}

void SensorReader::read_contact(const Keys& keys, Device& device) {
  const YamlNode* node = keys.find("collision");
  const auto name = node ? read_text(findings_, *node, "collision", "the name of a shape of its link") : std::nullopt;
  if (!name) return;
  const Link& link = model_.links[static_cast<std::size_t>(device.link)];
  std::vector<std::string> names;
  for (const Shape& shape : link.collisions) names.push_back(shape.name);
  const auto found = std::ranges::find(names, *name);
  if (found == names.end())
    return findings_.error(*node, fmt::format("link '{}' has no collision '{}'", link.name, shortened(*name)),
                           name_hint(*name, names, "collisions"));
  std::get<ContactSensor>(device.kind).collision = static_cast<int>(found - names.begin());
}

/// A force sensor measures the wrench of its link's joint.
void SensorReader::check_force(const Keys& keys, Device& device) {
  const Link& link = model_.links[static_cast<std::size_t>(device.link)];
  if (link.joint.type != JointType::free && link.parent >= 0) return;
  findings_.error(*keys.find("link"),
                  fmt::format("link '{}' has no joint that a force sensor could measure", link.name),
                  "expected a link behind a joint, a fixed one too");
}

}  // namespace

const Form& pose_form() { return bound_pose_form(); }
const Form& camera_form() { return bound_camera_form(); }
const Form& range_sensor_form() { return bound_range_sensor_form(); }
const Form& sweep_form() { return bound_sweep_form(); }

const Form& sensor_form() {
  static const BoundForm<Device> form{
      "sensor", "a sensor", with_common<Device>(types_of([](const DeviceKind& kind) { return !has_own_keys(kind); }))};
  return form;
}

const Form& contact_sensor_form() {
  static const BoundForm<Device> form{
      "contact_sensor", "a contact sensor",
      with_common<Device>(
          types_of<ContactSensor>(),
          {FormKey{"collision", types::text(), "the only shape of the link that counts; default: all"}})};
  return form;
}

const Form& form_of_sensor(const DeviceKind& kind) {
  if (std::holds_alternative<ContactSensor>(kind)) return contact_sensor_form();
  if (std::holds_alternative<Camera>(kind)) return camera_form();
  if (std::holds_alternative<RangeSensor>(kind)) return range_sensor_form();
  return sensor_form();
}

void read_sensors(Findings& findings, const YamlNode& node, ScenarioBody& body) {
  SensorReader reader(findings, body);
  for (const YamlNodePtr& sensor : read_list(findings, node, "sensors", "a list of {name: N, type: T, link: L, ...}"))
    reader.read(*sensor);
  Model model = reader.take();  // other bodies keep the model of the file
  std::ranges::stable_sort(model.devices, [](const Device& a, const Device& b) { return a.link < b.link; });
  body.model = std::make_shared<const Model>(std::move(model));
}

}  // namespace rehearse
