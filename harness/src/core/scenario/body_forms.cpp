// The keys of bodies and of their parts.
#include <rehearse/body.h>

#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

namespace rehearse {
namespace {

constexpr Range any_brightness{0.0, 1.0};

/// [red, green, blue], with opacity if `most_numbers` is 4.
ValueType color_of(std::size_t most_numbers) { return types::list(types::number(any_brightness), 3, most_numbers); }

ValueType rotation() {
  return types::either({types::list(types::quantity(angle_units, any_angle), 3, 3), types::of(rotation_form)});
}

FormKey color_key() { return {"color", color_of(4), "[red, green, blue], or with opacity, 0 to 1"}; }
FormKey checker_key() { return {"checker", types::of(checker_form), "squares of a second colour"}; }

/// A displacement of a joint that turns or slides.
ValueType displacement(const Range& range) {
  return types::either({types::quantity(angle_units, range), types::quantity(length_units, range)});
}

}  // namespace

const Form& rotation_form() {
  constexpr Range any_component{-1e6, 1e6};
  static const Form form{"rotation",
                         "a rotation",
                         {{"axis", types::vector3(any_component), "[x, y, z] of any length but 0"},
                          {"angle", types::quantity(angle_units, any_angle), "about the axis [rad]"},
                          {"quaternion", types::list(types::number(any_component), 4, 4), "[w, x, y, z]"}},
                         {},
                         {{"axis", "quaternion"}, {"angle", "quaternion"}}};
  return form;
}

const Form& pose_form() {
  static const Form form{"pose",
                         "a pose",
                         {{"position", types::vector3(any_position), "in the frame of the link [m]", "[0, 0, 0]"},
                          {"rotation", rotation(), "[roll, pitch, yaw], {axis, angle} or {quaternion}"}}};
  return form;
}

const Form& checker_form() {
  static const Form form{"checker",
                         "a checker",
                         {{"color", color_of(3), "of every second square", required},
                          {"size", types::number(any_length), "side of a square [m]"}}};
  return form;
}

const Form& box_form() {
  static const Form form{
      "box",
      "a box",
      {{"size", types::vector3(any_length), "full lengths [x, y, z] [m]", required}, color_key(), checker_key()}};
  return form;
}

const Form& sphere_form() {
  static const Form form{
      "sphere", "a sphere", {{"radius", types::number(any_length), "[m]", required}, color_key(), checker_key()}};
  return form;
}

const Form& cylinder_form() {
  static const Form form{"cylinder",
                         "a cylinder",
                         {{"radius", types::number(any_length), "[m]", required},
                          {"length", types::number(any_length), "along z [m]", required},
                          color_key(),
                          checker_key()}};
  return form;
}

const Form& heightmap_form() {
  static const Form form{"heightmap",
                         "a heightmap",
                         {{"file", types::text(), "a PNG or a grid of numbers, relative to the scenario", required},
                          {"size", types::list(types::number(any_length), 2, 2), "full lengths [x, y] [m]", required},
                          {"height", types::number({-1e4, 1e4, "[m]"}), "of white over black [m]; of a grid a factor"},
                          color_key()}};
  return form;
}

const Form& velocity_form() {
  static const Form form{"velocity",
                         "a velocity",
                         {{"linear", types::vector3(any_velocity), "[x, y, z] [m/s]", "[0, 0, 0]"},
                          {"angular", types::vector3(any_angular_velocity), "[x, y, z] [rad/s]", "[0, 0, 0]"}}};
  return form;
}

const Form& controller_form() {
  static const Form form{
      "controller",
      "a controller",
      {{"name", types::name(), "names its channels; default: that of its library"},
       {"library", types::some_text(), "a name such as SR1MinimumController, a path, or FILE.py:CLASS", required},
       {"options", types::text(), "its option string"},
       {"delay", types::flag(), "its outputs act one tick later", "true"},
       {"optional", types::flag(), "the run goes on without it if it refuses to start", "false"},
       {"children", types::list(types::of(controller_form)),
        "controllers that this one calls; they nest one level deep"}}};
  return form;
}

const Form& link_form() {
  static const Form form{"link",
                         "a link",
                         {{"mass", types::number(any_mass), "[kg]; its inertia changes in proportion"},
                          {"friction", types::number(any_friction), "coefficient in all directions"},
                          {"restitution", types::number(any_restitution), "of impacts"}}};
  return form;
}

const Form& belt_form() {
  static const Form form{
      "belt",
      "a belt",
      {{"link", types::text(), "the link whose surface runs", required},
       {"axis", types::vector3(any_position), "of the belt's wheels in the link's frame, as in [0, 1, 0]", required}}};
  return form;
}

const Form& joint_form() {
  static const Form form{
      "joint",
      "a joint",
      {{"name", types::name(), "unique among joints and welds"},
       {"type", types::word({"fixed", "revolute", "prismatic", "spherical"}), "the motion that it leaves", required},
       {"between", types::list(types::text(), 2, 2), "two links, [BODY/LINK, BODY/LINK]", required},
       {"at", types::vector3(any_position), "its place in the first link's frame [m]", "[0, 0, 0]"},
       {"axis", types::vector3({-1e6, 1e6}), "in the first link's frame, of any length but 0"}}};
  return form;
}

const Form& weld_form() {
  static const Form form{"weld",
                         "a weld",
                         {{"name", types::name(), "unique among joints and welds"},
                          {"between", types::list(types::text(), 2, 2), "two links, [BODY/LINK, BODY/LINK]", required},
                          {"from", types::number(any_time), "when it begins [s]", required},
                          {"until", types::number(any_time), "when it ends [s]", required}}};
  return form;
}

namespace {

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
std::vector<FormKey> with_common(std::vector<std::string> types_of_sensors, std::vector<FormKey> keys) {
  std::vector<FormKey> all{{"name", types::name(), "unique among the devices of the body", required},
                           {"type", types::word(std::move(types_of_sensors)), "the type of the sensor", required},
                           {"link", types::text(), "the link on which it is", required},
                           {"pose", types::of(pose_form), "in the frame of the link"}};
  all.insert(all.end(), keys.begin(), keys.end());
  return all;
}

FormKey rate_key(std::string_view fallback) {
  return {"rate", types::quantity(rate_units, {0.0, 1e6, "[Hz]", true}), "of measurements [Hz]", fallback};
}

}  // namespace

const Form& sensor_form() {
  static const Form form{"sensor", "a sensor",
                         with_common(types_of([](const DeviceKind& kind) { return !has_own_keys(kind); }), {})};
  return form;
}

const Form& form_of_sensor(const DeviceKind& kind) {
  if (std::holds_alternative<ContactSensor>(kind)) return contact_sensor_form();
  if (std::holds_alternative<Camera>(kind)) return camera_form();
  if (std::holds_alternative<RangeSensor>(kind)) return range_sensor_form();
  return sensor_form();
}

const Form& contact_sensor_form() {
  static const Form form{
      "contact_sensor", "a contact sensor",
      with_common(types_of<ContactSensor>(),
                  {{"collision", types::text(), "the shape of its link that is felt; default: all shapes"}})};
  return form;
}

const Form& camera_form() {
  static const Form form{
      "camera", "a camera",
      with_common(types_of<Camera>(), {rate_key("30"),
                                       {"width", types::whole(1, max_image_side), "[pixels]", "640"},
                                       {"height", types::whole(1, max_image_side), "[pixels]", "480"},
                                       {"horizontal_fov", types::quantity(angle_units, {0.0, 3.1, "[rad]", true}),
                                        "field of view [rad]", "1.047"},
                                       {"near", types::number({0.0, 1e6, "[m]", true}), "nothing nearer is drawn [m]"},
                                       {"far", types::number({0.0, 1e6, "[m]", true}), "nothing farther is drawn [m]"},
                                       {"shadows", types::flag(), "the sun's shadows are drawn"},
                                       {"antialiasing", types::flag(), "edges are smooth"}})};
  return form;
}

const Form& range_sensor_form() {
  constexpr Range any_distance{0.0, 1e6, "[m]"};
  static const Form form{
      "range_sensor", "a range sensor",
      with_common(types_of<RangeSensor>(),
                  {rate_key("10"),
                   {"yaw", types::of(sweep_form), "of the beams"},
                   {"pitch", types::of(sweep_form), "of the beams"},
                   {"min", types::number(any_distance), "beams pass through nearer shapes [m]", "0.1"},
                   {"max", types::number(any_distance), "beams end here [m]", "10"}})};
  return form;
}

const Form& sweep_form() {
  constexpr Range a_turn{-6.3, 6.3, "[rad]"};
  constexpr double most_beams = 1e6;
  static const Form form{"sweep",
                         "a sweep",
                         {{"from", types::quantity(angle_units, a_turn), "angle of the first beam [rad]", required},
                          {"to", types::quantity(angle_units, a_turn), "angle of the last beam [rad]", required},
                          {"samples", types::whole(1, most_beams), "number of beams", "1"}}};
  return form;
}

const Form& body_form() {
  const ValueType any_sensor = types::either(
      {types::of(sensor_form), types::of(contact_sensor_form), types::of(camera_form), types::of(range_sensor_form)});
  static const Form form{
      "body",
      "a body",
      {{"name", types::name(), "unique in the scenario; names channels", required},
       {"model", types::text(), "a URDF or .body file, relative to the scenario"},
       {"packages", types::map(types::some_text()),
        "NAME: DIRECTORY, the packages of ROS in which the model's meshes are"},
       {"box", types::of(box_form), "a shape of the scenario's own"},
       {"sphere", types::of(sphere_form), "a shape of the scenario's own"},
       {"cylinder", types::of(cylinder_form), "a shape of the scenario's own"},
       {"heightmap", types::of(heightmap_form), "a ground of the scenario's own"},
       {"mass", types::number(any_mass), "of a shape of the scenario's own [kg]"},
       {"default_mass", types::number(any_mass), "of links of the model without a mass [kg]"},
       {"fixed", types::flag(), "the root link is fixed to the world", "false"},
       {"dynamics", types::word({"forward", "kinematic"}), "kinematic: it moves as it is commanded", "forward"},
       {"allow_missing_meshes", types::flag(), "shapes whose mesh isn't found are left out", "false"},
       {"allow_unknown_devices", types::flag(), "devices of an unknown type are left out", "false"},
       {"mesh_up", types::word({"y", "z"}), "the upward axis of glTF meshes", "y"},
       {"joint_limits", types::flag(), "joints stop at the limits of the model"},
       {"collision", types::word({"automatic", "hull", "parts", "triangles"}), "the form in which meshes are touched",
        "automatic"},
       {"self_collision", types::flag(), "links of the body touch each other", "false"},
       {"effort_limits", types::flag(), "efforts are limited as the model states", "false"},
       {"friction", types::number(any_friction), "coefficient of a shape of the scenario's own"},
       {"mu2", types::number(any_friction), "coefficient across fdir1"},
       {"fdir1", types::vector3({-1e6, 1e6}), "direction of friction, of any length but 0"},
       {"restitution", types::number(any_restitution), "of a shape of the scenario's own"},
       {"position", types::vector3(any_position), "of the root link [m]"},
       {"rotation", rotation(), "[roll, pitch, yaw], {axis, angle} or {quaternion}"},
       {"joints", types::either({types::map(displacement(any_position)), types::list(displacement(any_position))}),
        "initial displacements: a map by name, or all by joint id [rad or m]"},
       {"velocity", types::of(velocity_form), "initial velocity of the root link"},
       {"controllers", types::list(types::of(controller_form)), "the programs that command it"},
       {"joint_velocities", types::map(types::number(any_velocity)), "initial velocities by joint [rad/s or m/s]"},
       {"links", types::map(types::of(link_form)), "masses and surfaces in place of the model's"},
       {"actuators", types::list(types::of(actuator_form)), "properties of drives, by joint"},
       {"sensors", types::list(any_sensor), "devices in addition to those of the model"},
       {"belts", types::list(types::of(belt_form)), "links whose surface runs"},
       {"faults", types::list(types::of(fault_form)),
        "failures of its sensors, encoders, actuators, links and controllers"}},
      {},
      {{"model", "box", "sphere", "cylinder", "heightmap"}}};
  return form;
}

}  // namespace rehearse
