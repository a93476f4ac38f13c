// The keys of bodies and of their parts.
#include <rehearse/body.h>

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "body_forms.h"
#include "scenario_forms.h"
#include "scenario_parts.h"
#include "scenario_values.h"

namespace rehearse {
namespace {

constexpr Range any_brightness{0.0, 1.0};

/// [red, green, blue], with opacity if `most_numbers` is 4.
ValueType color_of(std::size_t most_numbers) { return types::list(types::number(any_brightness), 3, most_numbers); }

FormKey color_key() { return {"color", color_of(4), "[red, green, blue], or with opacity, 0 to 1"}; }
FormKey checker_key() { return {"checker", types::of(checker_form), "squares of a second colour"}; }

/// A displacement of a joint that turns or slides.
ValueType displacement(const Range& range) {
  return types::either({types::quantity(angle_units, range), types::quantity(length_units, range)});
}

}  // namespace

ValueType rotation_type() {
  return types::either({types::list(types::quantity(angle_units, any_angle), 3, 3), types::of(rotation_form)});
}

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

const Form& belt_form() {
  static const Form form{
      "belt",
      "a belt",
      {{"link", types::text(), "the link whose surface runs", required},
       {"axis", types::vector3(any_position), "of the belt's wheels in the link's frame, as in [0, 1, 0]", required}}};
  return form;
}

const BoundForm<ScenarioBody>& bound_velocity_form() {
  static const BoundForm<ScenarioBody> form{
      "velocity",
      "a velocity",
      {{"linear", &ScenarioBody::linear_velocity, any_velocity, "[x, y, z] [m/s]"},
       {"angular", &ScenarioBody::angular_velocity, any_angular_velocity, "[x, y, z] [rad/s]"}}};
  return form;
}

const BoundForm<Checker>& bound_checker_form() {
  static const BoundForm<Checker> form{"checker",
                                       "a checker",
                                       {FormKey{"color", color_of(3), "of every second square", required},
                                        {"size", &Checker::size, any_length, "side of a square [m]"}}};
  return form;
}

const BoundForm<HeightmapSettings>& bound_heightmap_form() {
  static const BoundForm<HeightmapSettings> form{
      "heightmap",
      "a heightmap",
      {FormKey{"file", types::text(), "a PNG or a grid of numbers, relative to the scenario", required},
       FormKey{"size", types::list(types::number(any_length), 2, 2), "full lengths [x, y] [m]", required},
       {"height", &HeightmapSettings::height, {-1e4, 1e4, "[m]"}, "of white over black [m]; of a grid a factor"},
       color_key()}};
  return form;
}

const BoundForm<UrdfOptions>& model_file_keys() {
  static const BoundForm<UrdfOptions> form{
      "",
      "a body with a model file",
      {{"default_mass", &UrdfOptions::default_mass, any_mass,
        "of moving links of the model without a mass; default: they are errors [kg]"},
       {"allow_missing_meshes", &UrdfOptions::allow_missing_meshes,
        "shapes of the model whose meshes can't be had are left out, with a warning; else they are errors"},
       {"allow_unknown_devices", &UrdfOptions::allow_unknown_devices,
        "elements of a body file that are no known devices are left out, with a warning; else they are errors"},
       {"allow_unsupported", &UrdfOptions::allow_unsupported,
        "what a MuJoCo model has beyond this program is left out, with a note; else each is an error"},
       {"mesh_up",
        &UrdfOptions::mesh_z_up,
        {"y (as glTF states) or z (glTF meshes aren't turned)", {{"y", false}, {"z", true}}},
        "z: glTF meshes of the model have z up, against their standard, and aren't turned"}}};
  return form;
}

const BoundForm<Surface>& shape_surface_keys() {
  static const BoundForm<Surface> form{
      "",
      "a shape of the scenario's own",
      {{"friction", &Surface::friction, any_friction,
        "of a shape of the scenario's own; a contact has the smaller coefficient of both bodies, or the only one; "
        "default: that of the solver"},
       {"mu2", &Surface::second_friction, any_friction, "coefficient across fdir1; friction then acts along it"},
       {"restitution", &Surface::restitution, any_restitution,
        "ratio of the speeds after and before a bounce, of a shape of the scenario's own; the smaller or the only one "
        "applies; default: no bounce"}}};
  return form;
}

const BoundForm<ScenarioBody>& bound_body_form() {
  const ValueType any_sensor = types::either(
      {types::of(sensor_form), types::of(contact_sensor_form), types::of(camera_form), types::of(range_sensor_form)});
  static const BoundForm<ScenarioBody> form{
      "body",
      "a body",
      {FormKey{"name", types::name(),
               "unique in the scenario; names its channels; at most 100 bytes, no blanks, no / * ? [ ]", required},
       {"title", &ScenarioBody::title, "Body::name() for its controllers, any text of one line; default: name"},
       FormKey{"model", types::text(), "a URDF, .body or MuJoCo file, relative to the scenario"},
       FormKey{"packages", types::map(types::some_text()),
               "NAME: DIRECTORY, that of package://NAME or ${NAME} in the model, relative to the scenario; the same "
               "for all bodies of one model"},
       FormKey{"box", types::of(box_form), "a shape of the scenario's own"},
       FormKey{"sphere", types::of(sphere_form), "a shape of the scenario's own"},
       FormKey{"cylinder", types::of(cylinder_form), "a shape of the scenario's own"},
       FormKey{"heightmap", types::of(heightmap_form), "a ground of the scenario's own"},
       FormKey{"mass", types::number(any_mass),
               "of a box, sphere or cylinder, spread evenly; required unless it is fixed [kg]"},
       *model_file_keys().find("default_mass"),
       {"fixed", &ScenarioBody::fixed, "the root link is fixed to the world; a model can fix it, too"},
       {"dynamics",
        &ScenarioBody::kinematic,
        {"forward (it moves by its dynamics) or kinematic (as it is commanded)",
         {{"forward", false}, {"kinematic", true}}},
        "forward: it moves by its dynamics; kinematic: it follows its commands exactly, see below"},
       *model_file_keys().find("allow_missing_meshes"),
       *model_file_keys().find("allow_unknown_devices"),
       *model_file_keys().find("allow_unsupported"),
       *model_file_keys().find("mesh_up"),
       {"joint_limits", &ScenarioBody::joint_limits,
        "joints stop at the limits of the model; false, as in Choreonoid: they don't; default: they do"},
       {"collision",
        &ScenarioBody::contact,
        {"automatic, hull (meshes are touched as their convex hulls), parts (as convex parts), triangles (as they "
         "are) or none (it touches nothing)",
         {{"automatic", {MeshContact::automatic}},
          {"hull", {MeshContact::hull}},
          {"parts", {MeshContact::parts}},
          {"triangles", {MeshContact::triangles}},
          {"none", {MeshContact::automatic, false}}}},
        "what contacts take the model's meshes for, see below; triangles only if the body is fixed; none: it touches "
        "no body, and none of its links another"},
       {"self_collision", &ScenarioBody::self_collision,
        "its links can collide with each other, see below; default: only links that the model states"},
       {"effort_limits", &ScenarioBody::effort_limits,
        "commanded efforts are clamped to the effort limits of the joints"},
       {"drive_limits", &ScenarioBody::drive_limits,
        "drives of displacement and velocity keep to the limits of effort and velocity of the joints; false, as in "
        "Choreonoid: they reach their command in the step"},
       *shape_surface_keys().find("friction"),
       *shape_surface_keys().find("mu2"),
       FormKey{"fdir1", types::vector3({-1e6, 1e6}),
               "direction of friction in the body's frame, of any length but 0; default: [1, 0, 0]"},
       *shape_surface_keys().find("restitution"),
       FormKey{"position", types::vector3(any_position),
               "of the root link's frame; default: [0, 0, 0], or as in the model [m]"},
       FormKey{"rotation", rotation_type(),
               "[roll, pitch, yaw], {axis, angle} or {quaternion}, of the root link's frame, see below"},
       FormKey{"joints",
               types::either({types::map(displacement(any_position)), types::list(displacement(any_position))}),
               "initial displacements: a map by name, or all by joint id; default: 0, or with a warning the limit "
               "nearest to it [rad or m]"},
       FormKey{"posture", types::text(),
               "initial posture, one of the model's keyframes; joints, position and rotation replace parts of it"},
       FormKey{"velocity", types::of(velocity_form),
               "initial velocity of the root link's origin, world axes; not of a fixed or kinematic body"},
       FormKey{"controllers", types::list(types::of(controller_form)), "the programs that command it"},
       FormKey{"joint_velocities", types::map(types::number(any_velocity)),
               "initial velocities by joint; not of tracks, followers and kinematic bodies [rad/s or m/s]"},
       FormKey{"links", types::map(types::of(link_form)), "masses and surfaces in place of the model's"},
       FormKey{"actuators", types::list(types::of(actuator_form)),
               "properties of drives, by joint: delay, limits, friction, backlash; default: ideal drives"},
       FormKey{"sensors", types::list(any_sensor), "devices in addition to those of the model"},
       FormKey{"belts", types::list(types::of(belt_form)), "fixed links whose surface runs as a track's"},
       FormKey{"faults", types::list(types::of(fault_form)),
               "failures of its sensors, encoders, actuators, links and controllers for a time"}},
      {},
      {{"model", "box", "sphere", "cylinder", "heightmap"}}};
  return form;
}

const Form& velocity_form() { return bound_velocity_form(); }
const Form& checker_form() { return bound_checker_form(); }
const Form& heightmap_form() { return bound_heightmap_form(); }
const Form& body_form() { return bound_body_form(); }

}  // namespace rehearse
