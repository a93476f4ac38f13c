// Each key of a scenario's forms is read, and only once: a value of a wrong type is one error in its line.
#include <rehearse/scenario.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/scenario/scenario_forms.h"

namespace rehearse {
namespace {

/// A scenario around a map of a form.
struct KeyFrame {
  const Form& (*form)();
  std::string before, after;                                // the text on both sides of the map's keys
  std::vector<std::pair<std::string, std::string>> stated;  // keys that make the map valid
  std::set<std::string> instead = {};                       // keys in place of the first stated keys that they contain
  std::set<std::string> replaced = {};                      // the stated keys that those of `instead` replace
};

const std::string two_bodies =
    "{name: Box, mass: 1, box: {size: [1, 1, 1]}}, {name: Other, fixed: true, box: {size: [1, 1, 1]}}";
const std::string scenario_head = "rehearse: 1\nduration: 1\nbodies: [" + two_bodies + "]\n";
/// A scenario whose first body has a key with a map or a list.
KeyFrame of_body(const Form& (*form)(), const std::string& before, const std::string& after,
                 std::vector<std::pair<std::string, std::string>> stated) {
  return {form, "rehearse: 1\nduration: 1\nbodies: [{name: Box, mass: 1, box: {size: [1, 1, 1]}, " + before,
          after + "}]", std::move(stated)};
}

std::vector<KeyFrame> key_frames() {
  const std::pair<std::string, std::string> on_box{"link", "Box"}, named{"name", "Eye"};
  const std::set<std::string> conditions{"event", "no_event", "always", "eventually", "never"};
  const std::set<std::string> distributions{"log_uniform", "normal", "choice", "grid", "file", "linked"};
  return {
      {scenario_form, "{", "}", {{"rehearse", "1"}, {"duration", "1"}, {"bodies", "[" + two_bodies + "]"}}},
      {solver_form, scenario_head + "solver: {", "}", {}},
      {record_form, scenario_head + "record: {", "}", {}},
      {look_form, scenario_head + "look: {", "}", {}},
      {light_form, scenario_head + "look: {lights: [{", "}]}", {{"position", "[0, 0, 1]"}}},
      {pair_form,
       scenario_head + "materials: {Box: wood}\npairs: [{",
       "}]",
       {{"between", "[wood, wood]"}, {"friction", "1"}}},
      {push_form,
       scenario_head + "pushes: [{",
       "}]",
       {{"body", "Box"}, {"force", "[1, 0, 0]"}, {"from", "0"}, {"until", "1"}}},
      {joystick_entry_form, scenario_head + "joystick: [{", "}]", {{"at", "0"}, {"axes", "{L_STICK_V: 1}"}}},
      {tolerance_form, scenario_head + "tolerances: [{", "}]", {{"channel", "Box/*"}, {"atol", "1"}}},
      {expectation_form,
       scenario_head + "expect: [{",
       "}]",
       {{"channel", "Box/*"}, {"above", "1"}},
       conditions,
       {"channel"}},
      {joint_form, scenario_head + "joints: [{", "}]", {{"type", "fixed"}, {"between", "[Box, Other]"}}},
      {weld_form, scenario_head + "welds: [{", "}]", {{"between", "[Box, Other]"}, {"from", "0"}, {"until", "1"}}},
      {parameter_form,
       scenario_head + "vary: {p: {",
       "}}",
       {{"uniform", "[0, 1]"}, {"path", "seed"}},
       distributions,
       {"uniform"}},
      {normal_form,
       scenario_head + "vary: {p: {path: seed, normal: {",
       "}}}",
       {{"mean", "1"}, {"stddev", "1"}, {"from", "0"}, {"to", "2"}}},
      {grid_form,
       scenario_head + "vary: {p: {path: seed, grid: {",
       "}}}",
       {{"from", "0"}, {"to", "2"}, {"steps", "2"}}},
      {pass_rate_form, scenario_head + "pass_rate: {", "}", {{"at_least", "0.5"}}},
      {body_form,
       "rehearse: 1\nduration: 1\nbodies: [{",
       "}]",
       {{"name", "A"}, {"box", "{size: [1, 1, 1]}"}, {"fixed", "true"}}},
      of_body(velocity_form, "velocity: {", "}", {}),
      of_body(link_form, "links: {Box: {", "}}", {}),
      of_body(controller_form, "controllers: [{", "}]", {{"library", "Hold"}}),
      of_body(sensor_form, "sensors: [{", "}]", {named, on_box, {"type", "imu"}}),
      of_body(contact_sensor_form, "sensors: [{", "}]", {named, on_box, {"type", "contact"}}),
      of_body(camera_form, "sensors: [{", "}]", {named, on_box, {"type", "camera"}}),
      of_body(range_sensor_form, "sensors: [{", "}]", {named, on_box, {"type", "range"}}),
      of_body(pose_form, "sensors: [{name: Eye, type: imu, link: Box, pose: {", "}}]", {}),
      of_body(sweep_form, "sensors: [{name: Eye, type: range, link: Box, yaw: {", "}}]",
              {{"from", "0"}, {"to", "1"}, {"samples", "2"}}),
      {noise_form,
       "rehearse: 1\nduration: 1\nbodies: [{name: Box, mass: 1, box: {size: [1, 1, 1]}, sensors: [{name: Eye, type: "
       "camera, link: Box}]}]\nnoise: [{",
       "}]",
       {{"sensor", "Box/Eye"}},
       {"joint"},
       {"sensor"}}};
}

/// The scenario in which the key has the value of no key, and the line of the key.
std::pair<std::string, int> text_with(const KeyFrame& frame, std::string_view key) {
  std::string text = frame.before;
  const bool replaces = frame.instead.contains(std::string(key));
  for (const auto& [name, value] : frame.stated)
    if (name != key && !(replaces && frame.replaced.contains(name))) text += name + ": " + value + ", ";
  const auto line = 2 + std::ranges::count(text, '\n');
  text += '\n' + std::string(key) + ": {nonsense: [[]]}\n" + frame.after;
  return {text, static_cast<int>(line)};
}

TEST(ScenarioForms, ReadEachKeyOnce) {
  std::size_t count = 0;
  for (const KeyFrame& frame : key_frames()) {
    for (const FormKey& key : frame.form().keys) {
      SCOPED_TRACE(frame.form().owner);
      SCOPED_TRACE(key.name);
      const auto [text, line] = text_with(frame, key.name);
      const Result<Scenario> scenario = Scenario::parse(text, "keys.yaml", {});
      ASSERT_FALSE(scenario) << text;
      std::set<std::tuple<int, int, std::string>> errors;
      for (const Diagnostic& error : scenario.errors())
        EXPECT_TRUE(errors.emplace(error.line, error.column, error.message).second) << "twice: " << to_string(error);
      const bool is_read =
          std::ranges::any_of(scenario.errors(), [wanted = line](const Diagnostic& one) { return one.line == wanted; });
      EXPECT_TRUE(is_read) << to_string(scenario.errors()) << text;
      ++count;
    }
  }
  EXPECT_GT(count, 200u);
}

}  // namespace
}  // namespace rehearse
