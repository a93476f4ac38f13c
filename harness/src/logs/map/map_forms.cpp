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

#include "bound_map_forms.h"
#include "core/kinds/kinds.h"
#include "core/scenario/scenario_forms.h"

namespace rehearse {
namespace {

constexpr Range some_age{0.0, Scenario::max_duration, "[s]", true};
constexpr Range any_factor{-1e6, 1e6};
constexpr Range some_limit{0.0, 1e9, "", true};
constexpr Range moment_of_log{0.0, Scenario::max_duration, "[s]"};

constexpr const char* clock_text = "the time of a message: when it was written, or measured";
constexpr const char* age_text =
    "an older message at a tick is a gap; of the map: for all sources without their own; default: 0.1, cameras and "
    "scans "
    "1, a joystick never [s]";

ValueType topic() { return types::text(); }
/// A topic, or a map with it.
ValueType source(std::function<const Form&()> form) { return types::either({topic(), types::of(std::move(form))}); }
/// One, or a list of them.
ValueType one_or_more(const ValueType& type) { return types::either({type, types::list(type, 1)}); }

FormKey topic_key() { return {"topic", topic(), "the topic of its messages", required}; }
/// The clock of a source. Its default is the clock of the map.
template <class Source>
BoundKey<Source> clock_key() {
  BoundKey<Source> key{"clock", &Source::clock, clock_words(), clock_text};
  key.row.fallback.clear();
  return key;
}
template <class Source>
BoundKey<Source> offset_key() {
  return {"clock_offset", &Source::clock_offset, {-1e10, 1e10, "[s]"}, "of the stamps' clock from the log's [s]"};
}
template <class Source>
BoundKey<Source> age_key() {
  return {"max_age", &Source::max_age, some_age, age_text};
}
template <class Source>
BoundKey<Source> sampling_key() {
  return {"sampling",
          &Source::sampling,
          {"hold (the latest message) or interpolate (between two)",
           {{"hold", Sampling::hold}, {"interpolate", Sampling::interpolate}}},
          "the latest message, or between two"};
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

const Words<LogClock>& clock_words() {
  static const Words<LogClock> words{
      "log_time (when a message was written into the log) or header.stamp (when it was measured)",
      {{"log_time", LogClock::log_time}, {"header.stamp", LogClock::header_stamp}}};
  return words;
}

const BoundForm<TickSource>& bound_tick_form() {
  static const BoundForm<TickSource> form{
      "tick",
      "the tick",
      {topic_key(),
       {"grid", &TickSource::grid, "ticks are evenly spaced"},
       FormKey{"latency",
               types::either(
                   {types::number({0.0, Scenario::max_time_step, "[s], or measured"}), types::word({"measured"})}),
               "from a tick to its commands [s], or measured"},
       clock_key<TickSource>(),
       offset_key<TickSource>()}};
  return form;
}

const BoundForm<MappedController>& bound_map_controller_form() {
  static const BoundForm<MappedController> form{
      "controller",
      "the controller",
      {FormKey{"name", types::name(), "names its channels"},
       {"options", &MappedController::options, "its option string"},
       {"delay", &MappedController::delay, "its outputs act one tick later"}}};
  return form;
}

const BoundForm<JointRename>& bound_joint_rename_form() {
  static const BoundForm<JointRename> form{
      "joint_rename",
      "a joint",
      {FormKey{"joint", types::text(), "the joint of the model", required},
       {"scale", &JointRename::scale, any_factor, "the model's displacement per unit of the log's, as -1"},
       FormKey{"offset", types::quantity(angle_units, any_angle), "is added to the displacement [rad]", "0"}}};
  return form;
}

const BoundForm<JointSource>& bound_joint_source_form() {
  static const BoundForm<JointSource> form{
      "joint_source",
      "a source of joints",
      {topic_key(),
       FormKey{"names", types::map(types::either({types::text(), types::of(joint_rename_form)})),
               "from the log's names to the model's"},
       {"velocity",
        &JointSource::differentiate,
        {"message (the velocity in it) or differentiate (from two positions)",
         {{"message", false}, {"differentiate", true}}},
        "that in the message, or from two positions"},
       sampling_key<JointSource>(),
       age_key<JointSource>(),
       clock_key<JointSource>(),
       offset_key<JointSource>()}};
  return form;
}

const BoundForm<DeviceSource>& bound_number_source_form(const LogInput& input) {
  static std::map<std::string_view, BoundForm<DeviceSource>> made;  // by key of the map
  if (const auto known = made.find(input.key); known != made.end()) return known->second;
  std::vector<BoundKey<DeviceSource>> keys{topic_key(), device_key()};
  if (input.can_interpolate) keys.push_back(sampling_key<DeviceSource>());
  keys.insert(keys.end(), {age_key<DeviceSource>(), clock_key<DeviceSource>(), offset_key<DeviceSource>()});
  return made.emplace(input.key, BoundForm<DeviceSource>(input.form, input.owner, std::move(keys))).first->second;
}

const BoundForm<DeviceSource>& bound_camera_source_form() {
  static const BoundForm<DeviceSource> form{
      "camera_source",
      "a camera",
      {FormKey{"topic", topic(), "the topic of its pictures"}, FormKey{"depth", topic(), "the topic of its distances"},
       FormKey{"info", topic(), "the topic of its CameraInfo"}, device_key(), age_key<DeviceSource>(),
       clock_key<DeviceSource>(), offset_key<DeviceSource>()},
      {{"topic", "depth"}}};
  return form;
}

const BoundForm<DeviceSource>& bound_range_source_form() {
  static const BoundForm<DeviceSource> form{
      "range_source",
      "a range sensor",
      {topic_key(), device_key(), age_key<DeviceSource>(), clock_key<DeviceSource>(), offset_key<DeviceSource>()}};
  return form;
}

const BoundForm<JoyAxis>& bound_axis_source_form() {
  static const BoundForm<JoyAxis> form{"axis_source",
                                       "an axis",
                                       {FormKey{"index", types::whole(0, 255), "its number in the message", required},
                                        {"invert", &JoyAxis::invert, "the sign is changed"},
                                        {"scale", &JoyAxis::scale, any_factor, "factor of the position"}}};
  return form;
}

const BoundForm<JoySource>& bound_joystick_source_form() {
  static const BoundForm<JoySource> form{
      "joystick_source",
      "the joystick",
      {topic_key(),
       FormKey{"axes",
               types::map(types::either({types::whole(0, 255), types::of(axis_source_form)}),
                          names_and_numbers(joystick_axes)),
               "from names to numbers in the message"},
       FormKey{"buttons", types::map(types::whole(0, 255), names_and_numbers(joystick_buttons)),
               "from names to numbers in the message"},
       age_key<JoySource>(), clock_key<JoySource>(), offset_key<JoySource>()}};
  return form;
}

const BoundForm<RootSource>& bound_root_source_form() {
  static const BoundForm<RootSource> form{
      "root_source",
      "the root",
      {topic_key(), FormKey{"frame", types::text(), "of a TFMessage: the child frame of the transform"},
       sampling_key<RootSource>(), age_key<RootSource>(), clock_key<RootSource>(), offset_key<RootSource>()}};
  return form;
}

const BoundForm<CommandSource>& bound_command_source_form() {
  static const BoundForm<CommandSource> form{
      "command_source",
      "a source of commands",
      {topic_key(),
       FormKey{"names", types::map(types::either({types::text(), types::of(joint_rename_form)})),
               "from the log's names to the model's"},
       FormKey{"joints", names_in_order(), "of an array: the joint of each number; ~ for none"},
       FormKey{"quantity", types::word({"position", "velocity", "effort"}), "of an array"},
       {"shift", &CommandSource::shift, {-1000, 1000}, "ticks by which commands are later"},
       clock_key<CommandSource>(),
       offset_key<CommandSource>()}};
  return form;
}

const BoundForm<StateSource>& bound_state_source_form() {
  static const BoundForm<StateSource> form{
      "state_source",
      "a source of states",
      {topic_key(),
       FormKey{"names", names_in_order(), "the name of each number in rehearse_state(); ~ for none", required},
       clock_key<StateSource>(), offset_key<StateSource>()}};
  return form;
}

const Form& source_form(const LogInput& input) {
  switch (input.content) {
    case LogInput::Content::ranges: return range_source_form();
    case LogInput::Content::picture: return camera_source_form();
    default: return bound_number_source_form(input);
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
                    texts.emplace_back(fmt::format("{}, for {}", input->messages, input->devices))});
  }
  return keys;
}

BoundForm<LogMap> make_map_form() {
  const Range steps{Scenario::min_time_step, Scenario::max_time_step, "[s]"};
  std::vector<BoundKey<LogMap>> keys{
      FormKey{"rehearse_map", types::whole(1, 1), "version of the form", required},
      FormKey{"body", types::name(), "name of the robot in the recording; default: the model's name"},
      {"time_step", &LogMap::time_step, steps, "the controller's tick [s]", {"the controller's tick [s]"}},
      FormKey{"tick", source(map_tick_form),
              "a topic of which each message is a tick of the controller; default: a grid of time_step, from the first "
              "tick on"},
      FormKey{"clock", types::word(clock_words().names()), clock_text},
      FormKey{"start", types::text(), "the first tick: all, first, a topic of this map, or a time [s]", "all"},
      FormKey{"restart", one_or_more(types::number(moment_of_log)),
              "a fresh controller starts at this time, or at each of a list, see below [s]"},
      {"begins",
       &LogMap::begins_with_controller,
       {"run (the log may begin in the middle of a run) or controller (with the controller's start)",
        {{"run", false}, {"controller", true}}},
       "controller: the controller starts at the first tick; run: the log may begin in the middle of a run"},
      {"missing",
       &LogMap::skips_missing,
       {"hold (the controller is called on old inputs) or skip (it isn't called)", {{"hold", false}, {"skip", true}}},
       "where messages of tick are missing: hold, the controller is called on old inputs; skip, it isn't called"},
      FormKey{"renamed", types::map(topic()),
              "{/old: /new}: the topic /old of the map, or the joint of that name, is named /new later in the log"},
      {"angles",
       &LogMap::angles,
       {"radians, degrees (and degrees per second) or wrapped (within half a turn of 0)",
        {{"radians", LogAngles::radians}, {"degrees", LogAngles::degrees}, {"wrapped", LogAngles::wrapped}}},
       "of joints: radians; degrees; or wrapped, whose jumps by a turn are taken out"},
      {"take",
       &LogMap::take,
       {"first or last", {{"first", TakenCommand::first}, {"last", TakenCommand::last}}},
       "of several commands of a tick, the one that is compared; on a grid always the last"},
      {"zeros",
       &LogMap::zeros_are_foreign,
       {"compared, or unknown (they are those of an emergency stop)", {{"compared", false}, {"unknown", true}}},
       "a message whose commands are all 0 is compared, or its commands are unknown, as of an emergency stop"},
      FormKey{"limits",
              types::map(
                  types::either({types::quantity(UnitName("N·m").spellings(), some_limit),
                                 types::quantity(UnitName("N").spellings(), some_limit),
                                 types::quantity(angle_units, some_limit), types::quantity(length_units, some_limit)})),
              "{KNEE: 8 N·m}: the magnitude at which the driver clipped the commands of a joint"},
      FormKey{"max_age", types::number(some_age), age_text},
      FormKey{"controller", types::of(map_controller_form),
              "the controller that is fed; default: the library's name, no options, with delay"},
      FormKey{"joints", one_or_more(source(joint_source_form)),
              "a JointState: position, velocity and effort are q, dq and u; a topic, a source, or a list of them"}};
  std::vector<std::string_view> inputs{"joints"};
  for (FormKey& key : device_keys()) {
    inputs.push_back(key.name);
    keys.emplace_back(std::move(key));
  }
  inputs.insert(inputs.end(), {"joystick", "root"});
  const std::vector<BoundKey<LogMap>> others{
      FormKey{"joystick", source(joystick_source_form),
              "a Joy: a topic, or {topic, axes: {L_STICK_V: {index: 1, invert: true}}, buttons: {A: 0}}"},
      FormKey{"root", source(root_source_form),
              "the pose of the root link: a PoseStamped, an Odometry, or {topic: /tf, frame: base_link}"},
      FormKey{"commands", source(command_source_form),
              "the commands of the robot's controller, for comparison: a JointState, or another type"},
      FormKey{"state", types::of(state_source_form), "the state that the robot's controller published"},
      FormKey{"tolerances", types::list(types::of(tolerance_form)),
              "of these commands, as in a scenario; default: by their range"}};
  keys.insert(keys.end(), others.begin(), others.end());
  return {"map", "the map", std::move(keys), {std::move(inputs)}};
}

}  // namespace

const BoundForm<LogMap>& bound_map_form() {
  static const BoundForm<LogMap> form = make_map_form();
  return form;
}

const Form& map_tick_form() { return bound_tick_form(); }
const Form& map_controller_form() { return bound_map_controller_form(); }
const Form& joint_rename_form() { return bound_joint_rename_form(); }
const Form& joint_source_form() { return bound_joint_source_form(); }
const Form& camera_source_form() { return bound_camera_source_form(); }
const Form& range_source_form() { return bound_range_source_form(); }
const Form& axis_source_form() { return bound_axis_source_form(); }
const Form& joystick_source_form() { return bound_joystick_source_form(); }
const Form& root_source_form() { return bound_root_source_form(); }
const Form& command_source_form() { return bound_command_source_form(); }
const Form& state_source_form() { return bound_state_source_form(); }
const Form& map_form() { return bound_map_form(); }

}  // namespace rehearse
