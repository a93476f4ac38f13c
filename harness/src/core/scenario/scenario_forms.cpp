// The keys of a run.
#include "scenario_forms.h"

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <span>
#include <string>
#include <vector>

#include "scenario_parts.h"
#include "scenario_values.h"

namespace rehearse {
namespace {

constexpr Range any_color{0.0, 1.0};

ValueType moment() { return types::quantity(time_units, any_time); }
ValueType color() { return types::list(types::number(any_color), 3, 3); }

/// A control has a name and a number.
std::vector<std::string> with_numbers(const auto& names) {
  std::vector<std::string> all(names.begin(), names.end());
  for (std::size_t i = 0; i < names.size(); ++i) all.push_back(std::to_string(i));
  return all;
}

}  // namespace

const Form& golden_form() {
  static const Form form{
      "golden",
      "the golden",
      {{"name", types::matching("[A-Za-z0-9_-]+\\.[A-Za-z0-9_-]+"), "Suite.Test, the recording to compare with"},
       {"state", types::quantity(std::span(rate_units).first(1), {0.0, 1e9, "[Hz]", true}),
        "rate of the state and of sensors in the golden; the others are kept at every tick"}}};
  return form;
}

const Form& solver_form() {
  static const Form form{
      "solver",
      "the solver",
      {{"method", types::word({"direct", "quick", "exact"}), "direct: along trees of joints; quick and exact: ODE's",
        "direct"},
       {"iterations", types::whole(1, SolverSettings::most_iterations), "of the quick method", "50"},
       {"over_relaxation", types::number({0.0, 2.0, "", true, true}), "factor of the quick method", "1.3"},
       {"erp", types::number({0.0, 1.0}), "share of a joint's error that is corrected in a step", "0.4"},
       {"cfm", types::number({0.0, 1.0}), "softness of constraints", "1e-10"},
       {"max_correcting_velocity", types::number({0.0, 1e6, "[m/s]"}),
        "at which contacts separate overlapping shapes [m/s]", "0.01"},
       {"surface_layer", types::number({0.0, 1.0, "[m]"}), "depth at which contacts rest [m]", "0.0001"},
       {"friction", types::number({0.0, 1e6}), "coefficient of every contact", "1"},
       {"max_contacts", types::whole(1, 1000), "per pair of shapes", "100"},
       {"belt_depth", types::number({0.0, 1e6, "[m]", true}), "belts of tracks don't drive deeper contacts [m]"},
       {"sleep_after", types::number({0.0, 1e6, "[s]"}),
        "bodies without joints and devices that rest so long aren't simulated until something moves them; 0: never [s]",
        "0"},
       {"sleep_speed", types::number({0.0, 1e6, "[m/s]"}), "a body rests while no point of it is faster [m/s]",
        "0.01"}}};
  return form;
}

const Form& record_form() {
  static const Form form{"record", "record", {{"frames", types::flag(), "whether pictures are recorded", "true"}}};
  return form;
}

const Form& light_form() {
  const Range half_turn{0.0, 180.0, "[rad]"};
  static const Form form{
      "light",
      "a light",
      {{"position", types::vector3(any_position), "in the world [m]", required},
       {"color", color(), "[red, green, blue], 0 to 1", "[1, 1, 1]"},
       {"intensity", types::number({0.0, 1e6}), "is multiplied with the colour", "1"},
       {"range", types::number(any_length), "no light beyond this distance [m]"},
       {"direction", types::vector3({-1e6, 1e6}), "of a cone, in the world; of any length but 0"},
       {"beam_width", types::quantity(angle_units, half_turn), "full light up to this angle [rad]", "0.5"},
       {"cut_off_angle", types::quantity(angle_units, half_turn), "no light beyond this angle [rad]", "0.7"}}};
  return form;
}

const Form& look_form() {
  static const Form form{
      "look",
      "the look",
      {{"sky", color(), "colour of the background", "[0.55, 0.68, 0.82]"},
       {"shadows", types::flag(), "the sun's shadows are drawn", "false"},
       {"antialiasing", types::flag(), "edges are smooth", "false"},
       {"lights", types::list(types::of(light_form)), "beside the sky, the sun and the lights of robots"}}};
  return form;
}

const Form& pair_form() {
  static const Form form{"pair",
                         "a pair",
                         {{"between", types::list(types::text(), 2, 2), "two materials", required},
                          {"friction", types::number(any_friction), "coefficient between them"},
                          {"restitution", types::number(any_restitution), "of impacts between them"}},
                         {{"friction", "restitution"}}};
  return form;
}

const Form& push_form() {
  static const Form form{
      "push",
      "a push",
      {{"body", types::text(), "the body that is pushed", required},
       {"link", types::text(), "its link; default: the root"},
       {"force", types::vector3(any_force), "in the world frame [N]", "[0, 0, 0]"},
       {"torque", types::vector3(any_torque), "in the world frame [N·m]", "[0, 0, 0]"},
       {"at", types::vector3(any_position), "where the force acts, in the link's frame [m]", "[0, 0, 0]"},
       {"from", types::number(any_time), "when it begins [s]", required},
       {"until", types::number(any_time), "when it ends [s]", required}},
      {{"force", "torque"}}};
  return form;
}

const Form& joystick_entry_form() {
  static const Form form{
      "joystick_entry",
      "a joystick entry",
      {{"at", types::number(any_time), "when it begins [s]", required},
       {"axes", types::map(types::number({-1.0, 1.0}), with_numbers(joystick_axes)), "positions to which axes move"},
       {"buttons", types::map(types::flag(), with_numbers(joystick_buttons)), "true: pressed"},
       {"over", types::number(any_time), "duration of the move of axes [s]", "0"}},
      {{"axes", "buttons"}}};
  return form;
}

const Form& tolerance_form() {
  constexpr Range a_second{0.0, 1.0, "[s]"};  // a longer delay isn't a delay but a different motion
  static const Form form{
      "tolerance",
      "a tolerance",
      {{"channel", types::text_like("^[^/]"), "a pattern of channels, such as SR1/*/q", required},
       {"atol", types::number({0.0, 1e9}), "allowed difference, in the channel's unit"},
       {"rtol", types::number({0.0, 1.0}), "allowed difference as a share of the golden's value"},
       {"lead", types::number(a_second), "how much earlier a value may come [s]"},
       {"lag", types::number(a_second), "how much later a value may come [s]"},
       {"ticks", types::whole(0, 1000), "by how many ticks an event may move"},
       {"pixel_share", types::number({0.0, 1.0}), "share of a picture's pixels that may differ"},
       {"pixel_delta", types::number({0.0, 255.0}), "difference of a pixel's channel that isn't counted"},
       {"pixel_window", types::number({0.0, 1.0}), "share of the pixels of any square of 16 x 16 that may differ"}},
      {{"atol", "rtol", "lead", "lag", "ticks", "pixel_share", "pixel_delta", "pixel_window"}}};
  return form;
}

const Form& tolerances_file_form() {
  static const Form form{
      "tolerances_file",
      "the file",
      {{"tolerances", types::list(types::of(tolerance_form)), "allowed differences from the golden", required}}};
  return form;
}

const Form& expectation_form() {
  constexpr Range any_value{-1e12, 1e12};
  const ValueType measure = types::quantity(angle_units, any_value);
  const ValueType condition = types::some_text();
  static const Form form{
      "expectation",
      "an expectation",
      {{"channel", types::text_like("^[^/]"), "the series, or a pattern of series: each must satisfy the bounds"},
       {"event", types::some_text(), "a pattern: an event that matches must happen"},
       {"no_event", types::some_text(), "a pattern: no event that matches may happen"},
       {"above", measure, "the value must be above it"},
       {"below", measure, "the value must be below it"},
       {"near", measure, "the value must be within a distance of it"},
       {"within", types::either({measure, types::quantity(time_units, any_time)}),
        "the distance from near; of a condition: the time after `after`"},
       {"abs", types::flag(), "bounds apply to the magnitude", "false"},
       {"since", moment(), "values are compared with that at this time"},
       {"from", moment(), "beginning of the span in which it must hold [s]"},
       {"until", moment(), "end of the span in which it must hold [s]"},
       {"at", types::either({types::number(any_time), types::quantity(time_units, any_time), types::word({"end"})}),
        "the moment at which it must hold [s], or end"},
       {"sometime", types::flag(), "one value in the span is sufficient", "false"},
       {"always", condition, "a condition that holds at every tick"},
       {"eventually", condition, "a condition that holds at some tick"},
       {"never", condition, "a condition that holds at no tick"},
       {"after", condition, "the condition is demanded after each tick at which this one begins to hold"},
       {"except", condition, "ticks that are excepted, with the time of `for` after them"},
       {"for", moment(), "a time for which the condition holds, or for which `except` excepts [s]"},
       {"margin", types::either({measure, types::matching("[+-]?[0-9.eE+-]+ *%")}),
        "the required distance from a violation, as 10 % of the bound or in its unit"}},
      {},
      {{"channel", "event", "no_event", "always", "eventually", "never"}}};
  return form;
}

const Form& scenario_form() {
  constexpr double most_seed = 4294967295.0;
  static const Form form{
      "scenario",
      "the scenario",
      {{"rehearse", types::whole(1, 1), "version of the form", required},
       {"name", types::text_like("^[^/\n]+$"), "names files of the run; default: the file's name"},
       {"golden", types::either({types::matching("[A-Za-z0-9_-]+\\.[A-Za-z0-9_-]+"), types::of(golden_form)}),
        "the recording to compare with, Suite.Test"},
       {"duration", types::number({0.0, Scenario::max_duration, "[s]", true}), "duration of the run [s]", required},
       {"ends_when_done", types::flag(), "the run ends when control() of all controllers has returned false", "false"},
       {"planar", types::flag(), "root links stay in the plane of x and z in which they begin", "false"},
       {"time_step", types::number({Scenario::min_time_step, Scenario::max_time_step, "[s]"}),
        "of physics and controllers [s]", "0.001"},
       {"seed", types::whole(0, most_seed), "seed of the physics engine's generator", "0"},
       {"gravity", types::vector3(any_acceleration), "[x, y, z] [m/s²]", "[0, 0, -9.80665]"},
       {"options", types::text(), "option string for every controller, before its own"},
       {"solver", types::of(solver_form), "settings of the physics engine"},
       {"lever_arms", types::flag(), "accelerometers and IMUs measure at their own place", "true"},
       {"bodies", types::list(types::of(body_form), 1), "the bodies of the world, in this order", required},
       {"materials", types::map(types::name()), "BODY: NAME or BODY/LINK: NAME, the material of links"},
       {"pairs", types::list(types::of(pair_form)), "friction and restitution between two materials"},
       {"joints", types::list(types::of(joint_form)), "joints between links in addition to those of the models"},
       {"welds", types::list(types::of(weld_form)), "links that are fixed to each other for a time"},
       {"pushes", types::list(types::of(push_form)), "forces from outside"},
       {"joystick", types::list(types::of(joystick_entry_form)), "moves of axes and presses of buttons"},
       {"noise", types::list(types::of(noise_form)), "errors of readings"},
       {"look", types::of(look_form), "the background's colour, and settings of all cameras"},
       {"magnetic_field", types::vector3({-1e3, 1e3, "[T]"}), "[x, y, z], in world axes [T]", "[0, 0, 0]"},
       {"cameras", types::either({types::word({"all", "none"}), types::list(types::text())}),
        "cameras that take pictures: Body/Camera", "all"},
       {"record", types::of(record_form), "parts of the recording"},
       {"tolerances", types::list(types::of(tolerance_form)), "allowed differences from the golden"},
       {"horizon", types::number({0.0, Scenario::max_duration, "[s]"}),
        "time up to which channels are compared with the golden [s]"},
       {"expect", types::list(types::of(expectation_form)), "properties that the run must have"},
       {"simulate", types::word({"always", "unproved"}), "runs that a check simulates", "unproved"},
       {"vary", types::map(types::of(parameter_form)), "parameters that a campaign varies"},
       {"realtime", types::word({"counts"}), "the costs of control() are recorded and compared"},
       {"pass_rate", types::of(pass_rate_form), "the share of a campaign's cases that must pass"},
       {"sometimes", types::map(types::text()), "NAME: CONDITION, which some case of a campaign must reach"},
       {"plan", types::word({"random", "sobol", "latin_hypercube"}), "how a campaign draws its cases", "random"}}};
  return form;
}

}  // namespace rehearse
