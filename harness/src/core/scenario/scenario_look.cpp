// The `look` of a scenario: the background, lights, and settings of all cameras.
#include <fmt/format.h>

#include <numbers>

#include "bound_form.h"
#include "scenario_forms.h"
#include "scenario_parts.h"

namespace rehearse {
namespace {

constexpr Range any_color{0.0, 1.0};

/// A light while it is read.
struct LightKeys : Light {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  float beam_width = 0.5f, cut_off_angle = 0.7f;  // [rad]
};

const BoundForm<LightKeys>& bound_light_form() {
  constexpr Range half_turn{0.0, std::numbers::pi, "[rad] (180 deg)"};
  static const BoundForm<LightKeys> form{
      "light",
      "a light",
      {{"position", &LightKeys::position, any_position, "in the world [m]", {"[x, y, z] [m]"}},
       {"color", &LightKeys::color, any_color, "[red, green, blue], 0 to 1"},
       {"intensity", &LightKeys::intensity, {0.0, 1e6}, "is multiplied with the colour"},
       {"range", &LightKeys::range, any_length, "no light beyond this distance; default: unlimited [m]"},
       FormKey{"direction", types::vector3({-1e6, 1e6}),
               "of a cone, in the world, of any length but 0; default: in all directions"},
       {"beam_width", &LightKeys::beam_width, types::quantity(angle_units, half_turn),
        "with direction: full light up to this angle [rad]"},
       {"cut_off_angle", &LightKeys::cut_off_angle, types::quantity(angle_units, half_turn),
        "with direction: no light beyond this angle [rad]"}}};
  return form;
}

struct LookKeys : Look {
  Eigen::Vector3f background = sky.head<3>();
};

const BoundForm<LookKeys>& bound_look_form() {
  static const BoundForm<LookKeys> form{
      "look",
      "the look",
      {{"sky", &LookKeys::background, any_color, "colour of the background"},
       {"shadows", &LookKeys::shadows, "the sun's shadows are drawn"},
       {"antialiasing", &LookKeys::antialiasing, "edges are smooth"},
       FormKey{"lights", types::list(types::of(light_form)), "beside the sky, the sun and the lights of robots"}}};
  return form;
}

/// The cone of a light with a direction.
std::optional<LightCone> read_cone(Findings& findings, const Keys& keys, const LightKeys& light) {
  const YamlNode* direction = keys.find("direction");
  for (const char* key : {"beam_width", "cut_off_angle"})
    if (const YamlNode* found = keys.find(key); found && !direction)
      findings.error(*found, fmt::format("{} is given without direction", key),
                     "a light without direction shines in all directions");
  const auto along = direction ? read_vector3(findings, *direction, "direction", {-1e6, 1e6}) : std::nullopt;
  if (!along) return std::nullopt;
  if (along->isZero(0.0)) expected(findings, *direction, "direction", "a direction as in [0, 0, -1]");
  return LightCone{.direction = *along, .beam_width = light.beam_width, .cut_off_angle = light.cut_off_angle};
}

void read_light(Findings& findings, const YamlNode& node, Look& look) {
  const Keys keys(findings, node, light_form());
  if (!keys.is_map()) return;
  LightKeys light;
  bound_light_form().read(keys, light);
  light.cone = read_cone(findings, keys, light);
  look.lights.push_back({light, light.position});
}

}  // namespace

const Form& light_form() { return bound_light_form(); }
const Form& look_form() { return bound_look_form(); }

void read_look(Findings& findings, const YamlNode& node, Look& look) {
  const Keys keys(findings, node, look_form());
  LookKeys stated;
  bound_look_form().read(keys, stated);
  if (const YamlNode* lights = keys.find("lights"))
    for (const YamlNodePtr& light : read_list(findings, *lights, "lights", "a list of lights, each with a position"))
      read_light(findings, *light, stated);
  stated.sky.head<3>() = stated.background;
  look = std::move(stated);
}

}  // namespace rehearse
