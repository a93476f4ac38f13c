#include "map_forms.h"

#include <rehearse/io.h>
#include <rehearse/scenario.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/kinds/kinds.h"
#include "core/scenario/scenario_forms.h"
#include "core/scenario/scenario_values.h"

namespace rehearse {
namespace {

constexpr Range some_age{0.0, Scenario::max_duration, "[s]", true};
constexpr Range any_factor{-1e6, 1e6};
constexpr Range moment_of_log{0.0, Scenario::max_duration, "[s]"};

ValueType topic() { return types::text(); }
/// A topic, or a map with it.
ValueType source(std::function<const Form&()> form) { return types::either({topic(), types::of(std::move(form))}); }
/// One, or a list of them.
ValueType one_or_more(const ValueType& type) { return types::either({type, types::list(type, 1)}); }

FormKey topic_key() { return {"topic", topic(), "the topic of its messages", required}; }
FormKey clock_key() {
  return {"clock", types::word({"log_time", "header.stamp"}),
          "the time of a message: when it was written, or measured"};
}
FormKey offset_key() {
  return {"clock_offset", types::number({-1e10, 1e10, "[s]"}), "of the stamps' clock from the log's [s]"};
}
FormKey age_key() { return {"max_age", types::number(some_age), "older messages aren't used [s]"}; }
FormKey sampling_key() {
  return {"sampling", types::word({"hold", "interpolate"}), "the latest message, or between two", "hold"};
}
FormKey device_key() {
  return {"device", types::either({types::text(), types::list(types::text(), 1)}),
          "the device of the model, or a list of devices", required};
}

std::vector<std::string> names_and_numbers(const auto& names) {
  std::vector<std::string> all(names.begin(), names.end());
  for (std::size_t i = 0; i < names.size(); ++i) all.push_back(std::to_string(i));
  return all;
}

/// A name, or nothing in the place of a number that isn't used.
ValueType names_in_order() { return types::list(types::either({types::text(), types::empty()})); }

}  // namespace

const Form& map_tick_form() {
  static const Form form{
      "tick",
      "the tick",
      {topic_key(),
       {"grid", types::flag(), "ticks are evenly spaced", "false"},
       {"latency",
        types::either({types::number({0.0, Scenario::max_time_step, "[s], or measured"}), types::word({"measured"})}),
        "from a tick to its commands [s], or measured"},
       clock_key(),
       offset_key()}};
  return form;
}

const Form& map_controller_form() {
  static const Form form{"controller",
                         "the controller",
                         {{"name", types::name(), "names its channels"},
                          {"options", types::text(), "its option string"},
                          {"delay", types::flag(), "its outputs act one tick later"}}};
  return form;
}

const Form& joint_rename_form() {
  static const Form form{
      "joint_rename",
      "a joint",
      {{"joint", types::text(), "the joint of the model", required},
       {"scale", types::number(any_factor), "the model's displacement per unit of the log's, as -1", "1"},
       {"offset", types::quantity(angle_units, any_angle), "is added to the displacement [rad]", "0"}}};
  return form;
}

const Form& joint_source_form() {
  static const Form form{
      "joint_source",
      "a source of joints",
      {topic_key(),
       {"names", types::map(types::either({types::text(), types::of(joint_rename_form)})),
        "from the log's names to the model's"},
       {"velocity", types::word({"message", "differentiate"}), "that in the message, or from two positions", "message"},
       sampling_key(),
       age_key(),
       clock_key(),
       offset_key()}};
  return form;
}

const Form& number_source_form(const LogInput& input) {
  static std::map<std::string_view, Form> made;  // by key of the map
  const auto [place, is_new] = made.try_emplace(input.key);
  if (is_new) {
    place->second = {input.form, input.owner, {topic_key(), device_key()}};
    if (input.can_interpolate) place->second.keys.push_back(sampling_key());
    for (const FormKey& key : {age_key(), clock_key(), offset_key()}) place->second.keys.push_back(key);
  }
  return place->second;
}

const Form& camera_source_form() {
  static const Form form{"camera_source",
                         "a camera",
                         {{"topic", topic(), "the topic of its pictures"},
                          {"depth", topic(), "the topic of its distances"},
                          {"info", topic(), "the topic of its CameraInfo"},
                          device_key(),
                          age_key(),
                          clock_key(),
                          offset_key()},
                         {{"topic", "depth"}}};
  return form;
}

const Form& range_source_form() {
  static const Form form{
      "range_source", "a range sensor", {topic_key(), device_key(), age_key(), clock_key(), offset_key()}};
  return form;
}

const Form& axis_source_form() {
  static const Form form{"axis_source",
                         "an axis",
                         {{"index", types::whole(0, 255), "its number in the message", required},
                          {"invert", types::flag(), "the sign is changed", "false"},
                          {"scale", types::number(any_factor), "factor of the position", "1"}}};
  return form;
}

const Form& joystick_source_form() {
  static const Form form{"joystick_source",
                         "the joystick",
                         {topic_key(),
                          {"axes",
                           types::map(types::either({types::whole(0, 255), types::of(axis_source_form)}),
                                      names_and_numbers(joystick_axes)),
                           "from names to numbers in the message"},
                          {"buttons", types::map(types::whole(0, 255), names_and_numbers(joystick_buttons)),
                           "from names to numbers in the message"},
                          age_key(),
                          clock_key(),
                          offset_key()}};
  return form;
}

const Form& root_source_form() {
  static const Form form{"root_source",
                         "the root",
                         {topic_key(),
                          {"frame", types::text(), "of a TFMessage: the child frame of the transform"},
                          sampling_key(),
                          age_key(),
                          clock_key(),
                          offset_key()}};
  return form;
}

const Form& command_source_form() {
  static const Form form{"command_source",
                         "a source of commands",
                         {topic_key(),
                          {"names", types::map(types::either({types::text(), types::of(joint_rename_form)})),
                           "from the log's names to the model's"},
                          {"joints", names_in_order(), "of an array: the joint of each number; ~ for none"},
                          {"quantity", types::word({"position", "velocity", "effort"}), "of an array"},
                          {"shift", types::whole(-1000, 1000), "ticks by which commands are later", "0"},
                          clock_key(),
                          offset_key()}};
  return form;
}

const Form& state_source_form() {
  static const Form form{
      "state_source",
      "a source of states",
      {topic_key(),
       {"names", names_in_order(), "the name of each number in rehearse_state(); ~ for none", required},
       clock_key(),
       offset_key()}};
  return form;
}

const Form& source_form(const LogInput& input) {
  switch (input.content) {
    case LogInput::Content::ranges: return range_source_form();
    case LogInput::Content::picture: return camera_source_form();
    default: return number_source_form(input);
  }
}

namespace {

/// The keys of a map for devices: one for each kind of device that measures.
std::vector<FormKey> device_keys() {
  static std::deque<std::string> texts;
  std::vector<FormKey> keys;
  for (const LogInput* input : log_inputs()) {
    if (std::ranges::find(keys, input->key, &FormKey::name) != keys.end()) continue;
    keys.push_back({input->key, one_or_more(types::of([input]() -> const Form& { return source_form(*input); })),
                    texts.emplace_back(fmt::format("the topics of {}", input->devices))});
  }
  return keys;
}

Form make_map_form() {
  const Range steps{Scenario::min_time_step, Scenario::max_time_step, "[s]"};
  Form form{"map",
            "the map",
            {{"rehearse_map", types::whole(1, 1), "version of the form", required},
             {"body", types::name(), "names channels; default: the model's name"},
             {"time_step", types::number(steps), "the controller's tick [s]", required},
             {"tick", source(map_tick_form), "a topic of which each message is a tick"},
             clock_key(),
             {"start", types::text(), "all, first, a topic of this map, or a time [s]", "all"},
             {"restart", one_or_more(types::number(moment_of_log)), "times at which the controller restarts [s]"},
             {"begins", types::word({"run", "controller"}), "the log may begin in a run, or begins with the controller",
              "run"},
             {"missing", types::word({"hold", "skip"}), "at a missing tick: old inputs, or no call", "hold"},
             {"renamed", types::map(topic()), "from a topic of this map to its later name"},
             age_key(),
             {"controller", types::of(map_controller_form), "the controller that is fed"},
             {"joints", one_or_more(source(joint_source_form)), "the topics of the joints' states"},
             {"joystick", source(joystick_source_form), "the topic of the joystick"},
             {"root", source(root_source_form), "the topic of the root link's pose"},
             {"commands", source(command_source_form), "the topic of the commands to compare with"},
             {"state", types::of(state_source_form), "the topic of the state that a controller takes back"},
             {"tolerances", types::list(types::of(tolerance_form)), "allowed differences from the log's commands"}},
            {{"joints", "joystick", "root"}}};
  const std::vector<FormKey> of_devices = device_keys();
  for (const FormKey& key : of_devices) form.needed[0].insert(form.needed[0].end() - 2, key.name);
  form.keys.insert(std::ranges::find(form.keys, "joystick", &FormKey::name), of_devices.begin(), of_devices.end());
  return form;
}

}  // namespace

const Form& map_form() {
  static const Form form = make_map_form();
  return form;
}

}  // namespace rehearse
