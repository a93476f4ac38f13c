#include <rehearse/devices.h>

#include <cmath>
#include <utility>

namespace rehearse {
namespace {

DeviceForm form_of(const DeviceKind& kind) {
  return std::visit([](const auto& of_kind) { return of_kind.form(); }, kind);
}

template <std::size_t... indices>
std::vector<DeviceKind> default_kinds(std::index_sequence<indices...>) {
  return {DeviceKind(std::in_place_index<indices>)...};
}

/// The first kind with that name in the list; nullopt: none.
std::optional<DeviceKind> kind_named(std::string_view name, DeviceNames DeviceForm::*list) {
  for (const DeviceKind& kind : device_kinds())
    if ((form_of(kind).*list).has(name)) return kind;
  return std::nullopt;
}

}  // namespace

std::vector<DeviceKind> device_kinds() {
  std::vector<DeviceKind> kinds = default_kinds(std::make_index_sequence<std::variant_size_v<DeviceKind>>());
  Camera with_depth;
  with_depth.depth = true;
  kinds.emplace_back(with_depth);
  return kinds;
}

std::string_view type_name(const Device& device) { return form_of(device.kind).type; }

std::string_view scenario_type(const DeviceKind& kind) { return form_of(kind).scenario_types.first(); }

std::optional<DeviceKind> device_kind_of_urdf(std::string_view type) {
  return kind_named(type, &DeviceForm::urdf_types);
}

std::optional<DeviceKind> device_kind_of_body(std::string_view type) {
  return kind_named(type, &DeviceForm::body_types);
}

std::vector<MeasuredQuantity> quantities_of(const Device& device) {
  std::vector<MeasuredQuantity> quantities;
  const DeviceForm form = form_of(device.kind);
  for (const MeasuredQuantity& quantity : form.quantities.all())
    if (!quantity.name.empty()) quantities.push_back(quantity);
  return quantities;
}

int value_count(const Device& device) {
  return std::visit([](const auto& kind) { return kind.form().readings.values(); }, device.kind);
}

bool is_actuator(const Device& device) { return form_of(device.kind).readings.acts(); }

std::vector<Eigen::Vector3d> beam_directions(const RangeSensor& sensor) {
  std::vector<Eigen::Vector3d> ahead;  // horizontal direction of each yaw
  for (int i = 0; i < sensor.yaw.samples; ++i) {
    const double yaw = sensor.yaw.angle(i);
    ahead.emplace_back(-std::sin(yaw), 0.0, -std::cos(yaw));
  }
  std::vector<Eigen::Vector3d> directions;
  directions.reserve(static_cast<std::size_t>(sensor.beams()));
  for (int i = 0; i < sensor.pitch.samples; ++i) {
    const double pitch = sensor.pitch.angle(i);
    const double level = std::cos(pitch), up = std::sin(pitch);
    for (const Eigen::Vector3d& direction : ahead)
      directions.emplace_back(level * direction.x(), up, level * direction.z());
  }
  return directions;
}

Light light_of_state(Light light, const std::vector<double>& values) {
  constexpr std::size_t lamp = 8, spot = 14;
  if (values.size() < (light.cone ? spot : lamp)) return light;
  const auto number = [&values](std::size_t i) { return static_cast<float>(values[i]); };
  light.on = values[0] != 0.0;
  light.color = {number(1), number(2), number(3)};
  light.intensity = number(4);
  light.constant = number(5);
  light.linear = number(6);
  light.quadratic = number(7);
  if (!light.cone) return light;
  light.cone->direction = {values[8], values[9], values[10]};
  light.cone->beam_width = number(11);
  light.cone->cut_off_angle = number(12);
  light.cone->cut_off_exponent = number(13);
  return light;
}

}  // namespace rehearse
